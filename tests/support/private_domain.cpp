#include "tests/support/private_domain.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <net/if.h>
#include <net/route.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace lapis::test {
namespace {

constexpr int kFirstDomain = 60;  // 0 to 101 lie below Linux's ephemeral ports
constexpr int kLastDomain = 99;

void write_file(const char* path, const std::string& text) { std::ofstream(path) << text; }

// As root directly; else as root of a user namespace, where the kernel lets everybody create one.
bool enter_network_namespace() {
  if (unshare(CLONE_NEWNET) == 0) return true;
  const auto uid = getuid();
  const auto gid = getgid();
  if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
  write_file("/proc/self/setgroups", "deny");
  write_file("/proc/self/uid_map", "0 " + std::to_string(uid) + " 1");
  write_file("/proc/self/gid_map", "0 " + std::to_string(gid) + " 1");
  return true;
}

sockaddr address(const char* text) {
  sockaddr_in in{};
  in.sin_family = AF_INET;
  inet_pton(AF_INET, text, &in.sin_addr);
  sockaddr out{};
  std::memcpy(&out, &in, sizeof out);
  return out;
}

// A new namespace has a loopback interface that is down and no multicast route; ROS 2 peers on SUBNET need one.
bool bring_loopback_up() {
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  if (socket < 0) return false;
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  bool is_up = ioctl(socket, SIOCGIFFLAGS, &request) == 0;
  request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_UP | IFF_RUNNING | IFF_MULTICAST);
  is_up = is_up && ioctl(socket, SIOCSIFFLAGS, &request) == 0;
  char loopback[] = "lo";
  rtentry route{};
  route.rt_dst = address("224.0.0.0");
  route.rt_genmask = address("240.0.0.0");
  route.rt_flags = RTF_UP;
  route.rt_dev = loopback;
  ioctl(socket, SIOCADDRT, &route);  // without it LOCALHOST discovery still works
  ::close(socket);
  return is_up;
}

// The lock's descriptor is left open on purpose: children inherit it and keep the domain reserved.
int reserve_domain() {
  const auto folder = std::filesystem::temp_directory_path() / "lapis_test_domains";
  std::filesystem::create_directories(folder);
  std::error_code ignored;
  std::filesystem::permissions(folder, std::filesystem::perms::all, ignored);  // other users test here, too
  for (int domain = kFirstDomain; domain <= kLastDomain; ++domain) {
    const auto file = folder / std::to_string(domain);
    const int descriptor = open(file.c_str(), O_CREAT | O_RDWR, 0666);
    if (descriptor < 0) continue;
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return domain;
    ::close(descriptor);
  }
  throw std::runtime_error("no free DDS domain from 60 to 99; see the locks in " + folder.string());
}

}  // namespace

std::string enter_private_domain() {
  for (const char* name : {"ROS_STATIC_PEERS", "ROS_LOCALHOST_ONLY", "ROS_DISCOVERY_SERVER", "LAPIS_RUN",
                           "LAPIS_ALLOWED_PEERS", "FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE"}) {
    unsetenv(name);
  }
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", 1);
  const std::string domain = std::to_string(reserve_domain());
  setenv("ROS_DOMAIN_ID", domain.c_str(), 1);
  const bool is_alone =
      std::getenv("LAPIS_SHARED_NETWORK") == nullptr && enter_network_namespace() && bring_loopback_up();
  return "private domain: id " + domain + (is_alone ? " in a network namespace" : " on the loopback interface");
}

}  // namespace lapis::test
