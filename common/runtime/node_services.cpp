#include "common/runtime/node_services.hpp"

#include <utility>

#include "common/messages/time.hpp"
#include "common/runtime/type_description.hpp"
#include "common/topics/node.hpp"

namespace lapis::runtime {
namespace {

/// Serves a service of the table under the name of the node.
template <class Service>
void serve(Context& context, const dds::ServiceTopic<Service>& service,
           typename dds::ServiceServer<Service>::Handler handler) {
  const std::string name = "/" + context.name() + service.name;
  dds::ServiceTopic<Service> own = service;
  own.name = name.c_str();
  context.serve(own, std::move(handler));
}

}  // namespace

NodeServices::NodeServices(Context& context, parameters::Parameters parameters)
    : context_(context), parameters_(std::move(parameters)),
      node_(context.participant().names().full("/" + context.name())),
      events_(context.participant(), topics::kParameterEvents) {
  serve_reading();
  serve_setting();
  serve(context_, topics::kGetTypeDescription, describe_type);
}

void NodeServices::serve_reading() {
  serve(context_, topics::kListParameters, [this](const auto& request) {
    rcl_interfaces::srv::ListParameters_Response response;
    response.result(parameters_.list(request.prefixes(), request.depth()));
    return response;
  });
  serve(context_, topics::kGetParameters, [this](const auto& request) {
    rcl_interfaces::srv::GetParameters_Response response;
    for (const auto& name : request.names()) response.values().push_back(parameters_.value(name));
    return response;
  });
  serve(context_, topics::kGetParameterTypes, [this](const auto& request) {
    rcl_interfaces::srv::GetParameterTypes_Response response;
    for (const auto& name : request.names()) response.types().push_back(parameters_.descriptor(name).type());
    return response;
  });
  serve(context_, topics::kDescribeParameters, [this](const auto& request) {
    rcl_interfaces::srv::DescribeParameters_Response response;
    for (const auto& name : request.names()) response.descriptors().push_back(parameters_.descriptor(name));
    return response;
  });
}

void NodeServices::serve_setting() {
  serve(context_, topics::kSetParameters, [this](const auto& request) {
    rcl_interfaces::srv::SetParameters_Response response;
    for (const auto& parameter : request.parameters()) response.results().push_back(set({parameter}));
    return response;
  });
  serve(context_, topics::kSetParametersAtomically, [this](const auto& request) {
    rcl_interfaces::srv::SetParametersAtomically_Response response;
    response.result(set(request.parameters()));
    return response;
  });
}

rcl_interfaces::msg::SetParametersResult NodeServices::set(const std::vector<Parameter>& wanted) {
  const auto result = parameters_.set(wanted);
  if (!result.successful()) {
    if (context_.rate_limit().pass("parameter refused")) spdlog::warn("parameter refused: {}", result.reason());
    return result;
  }
  if (wanted.empty()) return result;
  rcl_interfaces::msg::ParameterEvent event;
  event.stamp(messages::to_message(context_.now()));
  event.node(node_);
  for (const Parameter& parameter : wanted) {
    Parameter changed;
    changed.name(parameter.name());
    changed.value(parameters_.value(parameter.name()));
    event.changed_parameters().push_back(changed);
    spdlog::info("{} = {}", parameter.name(), parameters_.text(parameter.name()));
  }
  events_.publish(event);
  return result;
}

}  // namespace lapis::runtime
