#pragma once

// The table of file formats, a row each: ROW(kind, group, endings, description, recognises, how).
//   kind         registry::Kind of the format
//   group        registry::Group, what kind of format it is for messages
//   endings      of file names, in lower case without the dot; the first is the kind's name.
//                .kanim is for projects with the .anim files of Unity or Maya
//   description  for messages: "is a BVH text file"
//   recognises   whether a content is such a file: starts<"BYTES">, or a function of registry.cpp;
//                tried in this order
//   how          members of io::Format: how it is read, by a function of formats/io, or by one that
//                needs nothing but the content: motion_of<dots::read>, actor_of<model::read>; none
//                if nothing opens it by kind alone
//
// registry.h makes its Kind of the rows, registry.cpp recognises by them, formats/io reads by them.
// Folders are searched for the endings of what can be read. One table for layers that may not
// include each other, hence a macro.

#define KROK_FORMATS(ROW)                                                                         \
  ROW(anim, own, "anim kanim", "a Krok motion (.anim)", begins_with<kAnimMagic>,                  \
      .read_motion = read_anim)                                                                   \
  ROW(model, own, "model", "a Krok model (.model)", begins_with<kModelMagic>,                     \
      .read_actor = actor_of<model::read>)                                                        \
  ROW(cam, own, "cam", "a Krok camera (.cam)", begins_with<kCamMagic>,                            \
      .read_actor = actor_of<cam::read>)                                                          \
  ROW(steps, own, "steps", "a Krok step library (.steps)", begins_with<kStepsMagic>)              \
  ROW(pc2, cache, "pc2", "a point cache (.pc2)", starts<"POINTCACHE2\0">)                         \
  ROW(bvh, capture, "bvh", "a BVH text file", is_bvh, .open_capture = open_bvh)                   \
  ROW(amc, capture, "amc", "an Acclaim motion (AMC)", is_amc, .open_capture = open_amc)           \
  ROW(asf, capture, "asf", "an Acclaim skeleton (ASF)", is_asf, .open_capture = open_asf,         \
      .companion = true)                                                                          \
  ROW(glb, gltf, "glb vrm vrma", "a binary glTF file (.glb)", starts<"glTF">,                     \
      .read_scene = read_gltf)                                                                    \
  ROW(material, own, "material", "Krok materials (.material)", is_json<kMaterialSchema>)          \
  ROW(character, own, "character", "a Krok character (.character)", is_json<kCharacterSchema>,    \
      .read_actor = read_character)                                                               \
  ROW(ragdoll, own, "ragdoll.json", "Krok bodies and joints (.ragdoll.json)",                     \
      is_json<kRagdollSchema>)                                                                    \
  ROW(correctives, own, "correctives", "Krok shapes by pose (.correctives)",                      \
      is_json<kCorrectivesSchema>)                                                                \
  ROW(gltf, gltf, "gltf", "a glTF file (.gltf)", is_gltf, .read_scene = read_gltf)                \
  ROW(npy, capture, "npy", "an array of numpy (.npy)", starts<"\x93NUMPY">,                       \
      .open_capture = open_arrays)                                                                \
  ROW(npz, capture, "npz", "arrays of numpy (.npz)", is_npz, .open_capture = open_arrays)         \
  ROW(zip, archive, "zip", "a ZIP archive", starts<"PK\x03\x04">, .read_scene = read_zipped_gltf) \
  ROW(fbx, scene, "fbx", "an FBX file", is_fbx, .read_scene = read_through_assimp)                \
  ROW(collada, scene, "dae", "a COLLADA file (.dae)", is_collada,                                 \
      .read_scene = read_through_assimp)                                                          \
  ROW(smd, scene, "smd", "a Valve SMD file", is_smd, .read_scene = read_through_assimp)           \
  ROW(ms3d, scene, "ms3d", "a MilkShape file (.ms3d)", starts<"MS3D000000">,                      \
      .read_scene = read_through_assimp)                                                          \
  ROW(max_3ds, scene, "3ds", "a 3DS file", is_3ds, .read_scene = read_through_assimp)             \
  ROW(ase, scene, "ase", "an ASE file", is_ase, .read_scene = read_through_assimp)                \
  ROW(md5mesh, scene, "md5mesh", "an MD5 mesh", is_md5mesh, .read_scene = read_through_assimp,    \
      .companion = true)                                                                          \
  ROW(md5anim, scene, "md5anim", "an MD5 motion (.md5anim)", is_md5anim,                          \
      .read_scene = read_through_assimp)
