#pragma once

// Matches the joints of two skeletons: part of matching.h, kept for includes of this name.
#include "compare/matching.h"
