#include "tests/benchmark/dds/lossy_link/link.hpp"

#include <fcntl.h>
#include <linux/if.h>
#include <linux/if_tun.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <deque>
#include <random>
#include <system_error>
#include <vector>

namespace lapis::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kLargestPacket = 1'500;                  // MTU of the devices [B]
constexpr auto kLongestQueue = std::chrono::milliseconds(50);  // of packets that wait for their turn on a slow link
constexpr std::size_t kMostInFlight = 200'000;                 // packets of one direction; 100 MB/s for 3 s

int checked(int result, const char* what) {
  if (result < 0) throw std::system_error(errno, std::generic_category(), what);
  return result;
}

/// One end of the link, in a network namespace of its own.
struct End {
  int name_space = -1;  // keeps the namespace alive
  int device = -1;
};

/// Moves the calling thread into a new network namespace and makes a TUN device named "lossy" there.
End make_end() {
  checked(unshare(CLONE_NEWNET), "unshare");
  End end;
  end.name_space = checked(open("/proc/thread-self/ns/net", O_RDONLY), "namespace");
  end.device = checked(open("/dev/net/tun", O_RDWR | O_NONBLOCK), "/dev/net/tun");
  ifreq request{};
  std::strcpy(request.ifr_name, "lossy");
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  checked(ioctl(end.device, TUNSETIFF, &request), "TUNSETIFF");
  return end;
}

struct Packet {
  Clock::time_point due;
  std::size_t size = 0;
  std::array<char, kLargestPacket> bytes;
};

/// One direction: packets that have been sent and not yet arrived.
class Direction {
 public:
  Direction(int from, int to, const LinkOptions& options, std::uint64_t number)
      : from_(from), to_(to), delay_(std::chrono::microseconds(static_cast<std::int64_t>(options.delay_ms * 1e3))),
        is_lost_(options.loss_percent / 100.0), random_(2 * options.seed + number), options_(options) {}

  void receive() {
    Packet packet;
    for (int i = 0; i < 256; ++i) {
      const ssize_t size = read(from_, packet.bytes.data(), packet.bytes.size());
      if (size <= 0) return;
      ++packets_;
      bytes_ += static_cast<std::uint64_t>(size);
      const auto now = Clock::now();
      if (is_lost_(random_) || is_out(now)) {
        ++lost_;
      } else if (in_flight_.size() >= kMostInFlight || free_ > now + kLongestQueue) {
        ++overflown_;
      } else {
        free_ = std::max(free_, now) + time_on_link(static_cast<double>(size));
        packet.due = free_ + delay_;
        packet.size = static_cast<std::size_t>(size);
        in_flight_.push_back(packet);
      }
    }
  }

  void deliver(Clock::time_point now) {
    for (; !in_flight_.empty() && in_flight_.front().due <= now; in_flight_.pop_front()) {
      const Packet& packet = in_flight_.front();
      if (write(to_, packet.bytes.data(), packet.size) < 0) ++overflown_;
    }
  }

  Clock::time_point next_due() const { return in_flight_.empty() ? Clock::time_point::max() : in_flight_.front().due; }

  void print() const {
    std::printf("{\"packets\": %lu, \"bytes\": %lu, \"lost\": %lu, \"overflown\": %lu}", packets_, bytes_, lost_,
                overflown_);
  }

 private:
  static Clock::duration seconds(double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  }
  Clock::duration time_on_link(double bytes) const {
    return options_.mbit_per_s > 0.0 ? seconds(8e-6 * bytes / options_.mbit_per_s) : Clock::duration::zero();
  }
  bool is_out(Clock::time_point now) const {
    const auto out_since = began_ + seconds(options_.outage_after_s);
    return now >= out_since && now < out_since + seconds(options_.outage_s);
  }

  int from_;
  int to_;
  Clock::duration delay_;
  std::bernoulli_distribution is_lost_;
  std::mt19937_64 random_;
  LinkOptions options_;
  Clock::time_point began_ = Clock::now();
  Clock::time_point free_;  // when the link has sent all that has come
  std::deque<Packet> in_flight_;
  std::uint64_t packets_ = 0;
  std::uint64_t bytes_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t overflown_ = 0;
};

int signals_as_file() {
  sigset_t ending;
  sigemptyset(&ending);
  sigaddset(&ending, SIGTERM);
  sigaddset(&ending, SIGINT);
  sigprocmask(SIG_BLOCK, &ending, nullptr);
  return checked(signalfd(-1, &ending, 0), "signalfd");
}

/// Until the next packet is due; null when there is none.
const timespec* until(Clock::time_point due, timespec& left) {
  if (due == Clock::time_point::max()) return nullptr;
  const auto ns = std::max<std::int64_t>(0, std::chrono::nanoseconds(due - Clock::now()).count());
  left = {ns / 1'000'000'000, ns % 1'000'000'000};
  return &left;
}

}  // namespace

int run_link(const LinkOptions& options) {
  const int signals = signals_as_file();
  const End a = make_end();
  const End b = make_end();
  std::printf("{\"namespaces\": [\"/proc/%d/fd/%d\", \"/proc/%d/fd/%d\"]}\n", getpid(), a.name_space, getpid(),
              b.name_space);
  std::fflush(stdout);
  Direction forth(a.device, b.device, options, 0);
  Direction back(b.device, a.device, options, 1);
  std::array<pollfd, 3> files = {pollfd{a.device, POLLIN, 0}, {b.device, POLLIN, 0}, {signals, POLLIN, 0}};
  while (files[2].revents == 0) {
    timespec left{};
    ppoll(files.data(), files.size(), until(std::min(forth.next_due(), back.next_due()), left), nullptr);
    forth.receive();
    back.receive();
    const auto now = Clock::now();
    forth.deliver(now);
    back.deliver(now);
  }
  std::printf("{\"forth\": ");
  forth.print();
  std::printf(", \"back\": ");
  back.print();
  std::printf("}\n");
  return 0;
}

}  // namespace lapis::test
