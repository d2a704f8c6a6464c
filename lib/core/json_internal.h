#pragma once

#include <nlohmann/json.hpp>

// For sources only, no public header: the two kinds of JSON object, members by name or in the order
// in which they were put in. They are compiled once, in json_instances.cpp, rather than in every
// source that uses them.

extern template class nlohmann::basic_json<>;
extern template class nlohmann::basic_json<nlohmann::ordered_map>;
