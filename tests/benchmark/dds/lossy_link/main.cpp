// Images and tiles over a link between two network namespaces that loses and delays packets: the link, and the
// processes at its ends. run.py beside this file starts them.
#include <CLI/CLI.hpp>

#include <iostream>

#include "tests/benchmark/dds/lossy_link/link.hpp"
#include "tests/benchmark/dds/lossy_link/sides.hpp"

namespace lapis::test {
namespace {

void add_load(CLI::App& app, Load& load) {
  app.add_option("--images-hz", load.images_hz, "images a second");
  app.add_option("--image-bytes", load.image_bytes, "size of an image [B]");
  app.add_option("--images", load.images, "number of images");
  app.add_option("--tiles", load.tiles, "number of tiles");
  app.add_option("--tile-bytes", load.tile_bytes, "size of a tile [B]");
}

/// Both sides must be given the same settings.
void add_settings(CLI::App& app, dds::ParticipantOptions& options) {
  auto& link = *options.link;
  auto& large = link.large;
  app.add_option("--socket-buffer", options.socket_buffer_bytes, "size of the UDP socket buffers [B]");
  app.add_option("--message-bytes", link.message_bytes, "largest RTPS message [B]");
  app.add_option("--pace-bytes", large.bytes_per_period, "bytes sent in a period; 0: written at once");
  app.add_option("--pace-ms", large.pace_period_ms, "period [ms]");
  app.add_option("--depth", large.depth, "depth of the history of images");
  app.add_option("--heartbeat-ns", large.heartbeat_ns, "period of heartbeats; 0: that of the topic");
  app.add_option("--heartbeat-response-ns", large.heartbeat_response_ns, "delay of a reader's answers");
  app.add_option("--nack-suppression-ns", large.nack_suppression_ns, "time in which requests are ignored");
  app.add_option("--heartbeat-with-data", large.heartbeat_with_data, "heartbeats with data, too");
}

int run(int argc, char** argv) {
  CLI::App app("Large samples over a lossy link", "lapis_lossy_link");
  app.require_subcommand(1);
  auto* link = app.add_subcommand("link", "makes two namespaces and carries packets between them");
  auto* publisher = app.add_subcommand("publish", "sends images and tiles");
  auto* subscriber = app.add_subcommand("subscribe", "receives them");
  LinkOptions link_options;
  link->add_option("--loss", link_options.loss_percent, "packets lost [%]")->check(CLI::Range(0.0, 100.0));
  link->add_option("--delay", link_options.delay_ms, "delay one way [ms]")->check(CLI::Range(0.0, 10'000.0));
  link->add_option("--rate", link_options.mbit_per_s, "rate [Mbit/s]; 0: any");
  link->add_option("--outage-after", link_options.outage_after_s, "time until nothing arrives for a while [s]");
  link->add_option("--outage", link_options.outage_s, "length of that while [s]");
  link->add_option("--seed", link_options.seed, "seed of the losses");
  dds::ParticipantOptions options;
  options.node_name = "lossy_link";
  options.discovery = dds::discovery_from_environment();
  options.link = dds::link_of(options.discovery);
  Load load;
  add_load(*publisher, load);
  bool uses_shared_memory = false;
  for (auto* side : {publisher, subscriber}) {
    add_settings(*side, options);
    side->add_flag("--shm", uses_shared_memory, "shared memory beside UDP");
  }
  CLI11_PARSE(app, argc, argv);
  if (uses_shared_memory) options.transport = dds::Transport::kSharedMemory;
  if (*link) return run_link(link_options);
  return *publisher ? publish(options, load) : subscribe(options);
}

}  // namespace
}  // namespace lapis::test

int main(int argc, char** argv) {
  try {
    return lapis::test::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "lapis_lossy_link: " << error.what() << '\n';
    return 1;
  }
}
