// Prints docs/topics.md from the topic table.
#include <iostream>
#include <string>
#include <utility>

#include "common/topics.hpp"

namespace {

std::string qos_text(const lapis::dds::Qos& qos) {
  std::string text = qos.latched ? "latched" : qos.sensor ? "reliable, sensor" : "reliable";
  if (qos.lifespan_s > 0) text += " for " + std::to_string(qos.lifespan_s) + " s,";
  if (qos.keyed) return text + ", keyed, 1 per key";
  text += " " + std::to_string(qos.depth);
  return qos.reader_depth > 0 ? text + ", readers " + std::to_string(qos.reader_depth) : text;
}

}  // namespace

int main() {
  std::cout
      << "# Topics\n\n"
         "Printed by `lapis_topics` from `common/topics/`; a test compares. Everything is RELIABLE and KEEP_LAST;\n"
         "*latched* is TRANSIENT_LOCAL, the rest VOLATILE; the number is the depth; *sensor*: read BEST_EFFORT where a "
         "writer\n"
         "offers no more (`dds.sensor_qos`). Names with a leading slash are ROS "
         "2\n"
         "names (`rt/...` on the wire); keyed topics are plain DDS, which ROS 2 tools do not see. `--namespace robot1` "
         "puts\n"
         "`/robot1` in front of all but the global ones (marked *).\n\n"
         "| topic | type | QoS | rate | from | what |\n| --- | --- | --- | --- | --- | --- |\n";
  lapis::topics::for_each([](const auto& topic) {
    using Message = typename std::decay_t<decltype(topic)>::Type;
    std::cout << "| `" << topic.name << "`" << (topic.is_global ? " *" : "") << " | "
              << lapis::idl::TypeSupport<Message>::kRosName << " | " << qos_text(topic.qos) << " | " << topic.rate
              << " | " << topic.from << " | " << topic.meaning << " |\n";
  });
  std::cout << "\n| service | type | from | what |\n| --- | --- | --- | --- |\n";
  lapis::topics::for_each_service([](const auto& service) {
    using Service = typename std::decay_t<decltype(service)>::Type;
    std::cout << "| `" << service.name << "`" << (service.is_global ? " *" : "") << " | "
              << lapis::idl::ServiceSupport<Service>::kRosName << " | " << service.from << " | " << service.meaning
              << " |\n";
  });
  lapis::topics::for_each_node_service([](const auto& service) {
    using Service = typename std::decay_t<decltype(service)>::Type;
    std::cout << "| `/<process>" << service.name << "` | " << lapis::idl::ServiceSupport<Service>::kRosName << " | "
              << service.from << " | " << service.meaning << " |\n";
  });
  std::cout
      << "\n`--remap from:=to` gives any of these, and the frames that processes name by themselves, another name. "
         "The frames:\n";
  const char* separator = "";
  for (const char* frame : lapis::topics::kFrames) std::cout << std::exchange(separator, ", ") << "`" << frame << "`";
  std::cout << ".\n";
}
