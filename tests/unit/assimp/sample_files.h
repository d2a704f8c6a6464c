#pragma once

// Small files in the formats that are read through Assimp.

#include "unit/assimp/sample_3ds.h"
#include "unit/assimp/sample_ase.h"
#include "unit/assimp/sample_collada.h"
#include "unit/assimp/sample_fbx.h"
#include "unit/assimp/sample_md5.h"
#include "unit/assimp/sample_ms3d.h"
#include "unit/assimp/sample_smd.h"
