// Writes an ONNX file whose classes are colours, and which gives their indices: lapis_color_network FILE WIDTH HEIGHT R
// G B ...
#include <cstdlib>
#include <fstream>

#include "tests/support/color_network.hpp"

int main(int argc, char** argv) {
  lapis::test::ColorNetwork network;
  network.ending = "ArgMax";
  if (argc < 10) return 2;
  network.width = std::atoi(argv[2]);
  network.height = std::atoi(argv[3]);
  const auto channel = [&](int i) { return static_cast<std::uint8_t>(std::atoi(argv[i])); };
  for (int i = 4; i + 2 < argc; i += 3) network.colors.push_back({channel(i), channel(i + 1), channel(i + 2)});
  const std::string bytes = lapis::test::onnx_file(network);
  return std::ofstream(argv[1], std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size())) ? 0
                                                                                                                  : 1;
}
