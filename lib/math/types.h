#pragma once

// Short names for vectors and quaternions: part of transform.h, kept for includes of this name.
#include "math/transform.h"
