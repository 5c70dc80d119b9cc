#include "command_line/service_call.hpp"

#include <algorithm>
#include <set>

#include "common/cdr/decode.hpp"
#include "common/cdr/encode.hpp"
#include "common/dds/raw.hpp"
#include "idl/type_table.hpp"

namespace lapis::command_line {
namespace {

constexpr std::string_view kRequest = "_Request", kResponse = "_Response";

/// Waits for a server; its type of requests.
std::string request_type_of(Domain& domain, const std::string& name) {
  std::vector<SeenService> services;
  std::string type;
  const bool is_found = domain.wait_until(
      [&] {
        services = domain.services();
        const auto found = std::ranges::find(services, name, &SeenService::name);
        if (found != services.end()) type = found->request_type;
        return found != services.end();
      },
      domain.patience());
  if (is_found && type.ends_with(kRequest)) return type;
  if (is_found) throw Failure(kWrongCall, name + " has a type that is no service of ROS 2");
  std::set<std::string> names;
  for (const SeenService& service : services) names.insert(service.name);
  throw Failure(kNotThere, not_among("service", name, {names.begin(), names.end()}));
}

}  // namespace

cdr::Layout known_layout(const std::string& type) {
  const idl::TypeEntry* entry = idl::find(type);
  if (entry == nullptr) throw Failure(kWrongCall, "this build does not know the type " + type);
  return cdr::parse_ros2msg(entry->ros_name, entry->ros2msg_text);
}

cdr::Value call(Domain& domain, const std::string& service, const cdr::Value& request) {
  const std::string request_type = request_type_of(domain, service);
  const std::string response_type =
      request_type.substr(0, request_type.size() - kRequest.size()) + std::string(kResponse);
  const cdr::Layout request_layout = known_layout(request_type), response_layout = known_layout(response_type);
  cdr::Bytes bytes;
  try {
    bytes = cdr::encode(request_layout, request);
  } catch (const std::runtime_error& error) {
    throw Failure(kWrongCall, "the request is no " + request_type + ": " + error.what());
  }
  auto& client =
      domain.add<dds::RawClient>(service, dds::dds_type_name(request_type), std::string(idl::find(request_type)->hash),
                                 dds::dds_type_name(response_type), std::string(idl::find(response_type)->hash));
  domain.participant().announce_graph();
  if (!domain.wait_until([&] { return client.is_ready(); }, domain.patience())) {
    throw Failure(kTooLate, service + " is announced, but cannot be reached");
  }
  const auto number = client.call(bytes);
  if (!number) throw Failure(kTooLate, "DDS has not sent the request");
  std::optional<dds::RawType::Bytes> reply;
  if (!domain.wait_until([&] { return (reply = client.take_reply(*number)).has_value(); }, domain.patience())) {
    throw Failure(kTooLate, service + " has not answered");
  }
  return cdr::decode(response_layout, *reply);
}

bool is_success(const cdr::Value& response) {
  for (const char* name : {"success", "successful"}) {
    const auto found = response.find(name);
    if (found != response.end() && found->is_boolean()) return found->get<bool>();
  }
  return true;
}

}  // namespace lapis::command_line
