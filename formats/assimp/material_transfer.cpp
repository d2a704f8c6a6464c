#include "formats/assimp/material_transfer_internal.h"

namespace krok::assimp {

namespace {

void put_texture(ByteWriter& out, const Texture& texture,
                 std::map<const EncodedImage*, std::int32_t>& number_of) {
  std::int32_t number = -1;
  bool added = false;
  if (texture) {
    const auto next = static_cast<std::int32_t>(number_of.size());
    const auto entry = number_of.try_emplace(texture.image.get(), next);
    number = entry.first->second;
    added = entry.second;
  }
  out.write(number);
  if (added) {
    put_text(out, texture.image->name);
    put_text(out, texture.image->path);
    put_array(out, texture.image->bytes);
  }
  out.write(static_cast<std::uint8_t>(texture.wrap_u));
  out.write(static_cast<std::uint8_t>(texture.wrap_v));
}

template <typename T>
T take_kind(Parser& in, T last) {
  const auto number = in.number<std::uint8_t>();
  in.require(number <= static_cast<std::uint8_t>(last), "a material has an unknown kind");
  return static_cast<T>(number);
}

Texture take_texture(Parser& in, std::vector<std::shared_ptr<const EncodedImage>>& images) {
  Texture texture;
  const auto number = in.number<std::int32_t>();
  const auto known = static_cast<std::int32_t>(images.size());
  in.require(number >= -1 && number <= known, "a texture has an image that does not exist");
  if (in.ok() && number == known) {
    EncodedImage image;
    image.name = in.text();
    image.path = in.text();
    image.bytes = in.array<std::byte>();
    images.push_back(std::make_shared<const EncodedImage>(std::move(image)));
  }
  if (in.ok() && number >= 0) texture.image = images[static_cast<std::size_t>(number)];
  texture.wrap_u = take_kind(in, Texture::Wrap::mirror);
  texture.wrap_v = take_kind(in, Texture::Wrap::mirror);
  return texture;
}

}  // namespace

// Writes the members that convert_materials fills in.
void put_material(ByteWriter& out, const Material& material,
                  std::map<const EncodedImage*, std::int32_t>& number_of) {
  put_text(out, material.name);
  for (int k = 0; k < 4; ++k) out.write(material.base_color[k]);
  for (int k = 0; k < 3; ++k) out.write(material.emissive[k]);
  for (const float factor : {material.metallic, material.roughness}) out.write(factor);
  out.write(static_cast<std::uint8_t>(material.alpha));
  out.write(static_cast<std::uint8_t>(material.double_sided));
  for (const Texture* texture : textures_of(material)) put_texture(out, *texture, number_of);
}

Material take_material(Parser& in, std::vector<std::shared_ptr<const EncodedImage>>& images) {
  Material material;
  material.name = in.text();
  for (int k = 0; k < 4; ++k) material.base_color[k] = in.number<float>();
  for (int k = 0; k < 3; ++k) material.emissive[k] = in.number<float>();
  for (float* factor : {&material.metallic, &material.roughness}) *factor = in.number<float>();
  material.alpha = take_kind(in, Material::Alpha::blend);
  material.double_sided = in.number<std::uint8_t>() != 0;
  for (Texture* texture : textures_of(material)) *texture = take_texture(in, images);
  return material;
}

}  // namespace krok::assimp
