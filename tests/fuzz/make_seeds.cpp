// Writes the first inputs of the fuzzers: lapis_fuzz_seeds FOLDER makes FOLDER/NAME/0, FOLDER/NAME/1, ...

#include <iostream>

#include "message_seeds.hpp"
#include "seeds.hpp"
#include "unit/simulator/assets/asset_files.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: lapis_fuzz_seeds FOLDER\n";
    return 2;
  }
  auto seeds = lapis::simulator::fuzz::seeds();
  seeds["message"] = lapis::fuzz::message_seeds();
  for (const auto& [name, inputs] : seeds) {
    const auto folder = std::filesystem::path(argv[1]) / name;
    for (std::size_t i = 0; i < inputs.size(); ++i)
      lapis::simulator::test::write_file(folder / std::to_string(i), inputs[i]);
  }
  return 0;
}
