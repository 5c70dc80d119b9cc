// All readers of small texts beside a scene, one after the other.

#include <cstdlib>
#include <stdexcept>

#include "fuzz_files.hpp"
#include "simulator/core/assets/java_properties.hpp"
#include "simulator/core/assets/mtl.hpp"
#include "simulator/core/loaders/csv_table.hpp"
#include "simulator/core/loaders/hm3d.hpp"
#include "simulator/core/loaders/matterport.hpp"
#include "simulator/core/loaders/semantics_json.hpp"
#include "simulator/core/loaders/uri.hpp"

namespace {

using namespace lapis::simulator;

template <class Read>
void attempt(Read read) {
  try {
    read();
  } catch (const std::runtime_error& error) {
    if (*error.what() == '\0') std::abort();
  }
}

void read_table(std::string_view text, char separator) {
  const CsvTable table(text, separator, "fuzz");
  for (const auto& row : table.rows()) {
    for (const char* column : {"class_id", "instance_id"}) {
      attempt([&] {
        if (table.index_at(row, column, 65535) > 65535) std::abort();
      });
    }
    attempt([&] { table.float_at(row, "m00"); });
  }
}

void read_semantics(std::string_view text) {
  for (const auto& entry : parse_semantics(text, "fuzz").instances) {
    if (entry.id < 1 || entry.id > 65535 || (!entry.node && !entry.material)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  read_table(text, ',');
  read_table(text, '\t');
  attempt([&] { read_semantics(text); });
  attempt([&] { parse_hm3d_instances(text, "fuzz"); });
  attempt([&] { parse_hm3d_mapping(text, "fuzz"); });
  attempt([&] { parse_house(text, "fuzz"); });
  parse_mtl(text);
  parse_java_properties({data, size});
  decode_percent(text);
  decode_data_uri(text);
  return 0;
}
