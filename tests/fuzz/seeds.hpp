#pragma once

#include <map>
#include <string>
#include <vector>

#include "fuzz_files.hpp"

namespace lapis::simulator::fuzz {

/// First inputs by the name of the fuzzer.
using Seeds = std::map<std::string, std::vector<Bytes>>;

/// Small whole files of every kind, made by code.
Seeds seeds();

}  // namespace lapis::simulator::fuzz
