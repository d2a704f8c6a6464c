#pragma once

#include <fmt/format.h>

#include <string>

#include "unit/assimp/sample_rig.h"

// The rig's mesh as ASE, by the format's description and without any library.

namespace krok::test {

// A mesh "body" that moves and turns by samples at uneven times (ticks of 1/4800 s), and a camera.
inline std::string ase() {
  std::string text =
      "*3DSMAX_ASCIIEXPORT\t200\n*COMMENT \"made for a test\"\n*SCENE {\n\t*SCENE_FILENAME \"\"\n"
      "\t*SCENE_FIRSTFRAME 0\n\t*SCENE_LASTFRAME 30\n\t*SCENE_FRAMESPEED 30\n"
      "\t*SCENE_TICKSPERFRAME 160\n}\n";
  text +=
      "*GEOMOBJECT {\n\t*NODE_NAME \"body\"\n\t*NODE_TM {\n\t\t*NODE_NAME \"body\"\n"
      "\t\t*TM_ROW0 1 0 0\n\t\t*TM_ROW1 0 1 0\n\t\t*TM_ROW2 0 0 1\n\t\t*TM_ROW3 0 0 0\n\t}\n"
      "\t*MESH {\n\t\t*TIMEVALUE 0\n\t\t*MESH_NUMVERTEX 4\n\t\t*MESH_NUMFACES 2\n"
      "\t\t*MESH_VERTEX_LIST {\n";
  for (std::size_t c = 0; c < 4; ++c) {
    const Vec3 p = corners()[c];
    text += fmt::format("\t\t\t*MESH_VERTEX {} {} {} {}\n", c, p[0], p[1], p[2]);
  }
  text += "\t\t}\n\t\t*MESH_FACE_LIST {\n";
  for (std::size_t t = 0; t < 2; ++t) {
    const auto triangle = corner_triangles()[t];
    text += fmt::format(
        "\t\t\t*MESH_FACE {}: A: {} B: {} C: {} AB: 1 BC: 1 CA: 1\t*MESH_SMOOTHING 1 "
        "\t*MESH_MTLID 0\n",
        t, triangle[0], triangle[1], triangle[2]);
  }
  text +=
      "\t\t}\n\t}\n\t*TM_ANIMATION {\n\t\t*NODE_NAME \"body\"\n\t\t*CONTROL_POS_TRACK {\n"
      "\t\t\t*CONTROL_POS_SAMPLE 0 0 0 0\n\t\t\t*CONTROL_POS_SAMPLE 640 1 0 0\n"
      "\t\t\t*CONTROL_POS_SAMPLE 4800 1 2 0\n\t\t}\n\t\t*CONTROL_ROT_TRACK {\n"
      "\t\t\t*CONTROL_ROT_SAMPLE 0 0 0 1 0\n\t\t\t*CONTROL_ROT_SAMPLE 640 0 0 1 0.5\n"
      "\t\t\t*CONTROL_ROT_SAMPLE 4800 1 0 0 0.25\n\t\t}\n\t}\n}\n";
  text +=
      "*CAMERAOBJECT {\n\t*NODE_NAME \"eye\"\n\t*CAMERA_TYPE Free\n\t*NODE_TM {\n"
      "\t\t*NODE_NAME \"eye\"\n\t\t*TM_ROW0 1 0 0\n\t\t*TM_ROW1 0 0 1\n\t\t*TM_ROW2 0 -1 0\n"
      "\t\t*TM_ROW3 0 -5 1\n\t}\n\t*CAMERA_SETTINGS {\n\t\t*TIMEVALUE 0\n\t\t*CAMERA_NEAR 0\n"
      "\t\t*CAMERA_FAR 1000\n\t\t*CAMERA_FOV 0.8\n\t\t*CAMERA_TDIST 5\n\t}\n}\n";
  return text;
}

}  // namespace krok::test
