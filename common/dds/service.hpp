#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/dds/subscription.hpp"
#include "common/dds/writer.hpp"

namespace lapis::dds {

// Requests and replies are topics; a reply names its request by the related sample identity (ros2-interop 5.1).

/// Identity of a request: the client's reply reader (or its request writer, if the request does not name the reader)
/// and a sequence number.
struct RequestId {
  compat::rtps::SampleIdentity identity;
  Gid client{};
};

/// Serves one service; requests are handled on the executor's thread. Equal requests that wait together are handled
/// once and answered alike, unless every call counts, and after each handling the service rests for as long as the
/// handling took, so that a flood of requests takes at most half of the process's time.
template <class Service>
class ServiceServer : public Source {
  using Request = typename idl::ServiceSupport<Service>::Request;
  using Response = typename idl::ServiceSupport<Service>::Response;
  using Clock = std::chrono::steady_clock;

 public:
  using Handler = std::function<Response(const Request&)>;

  ServiceServer(Participant& participant, const ServiceTopic<Service>& service, Handler handler)
      : Source(participant, request_dds_name(full_name(service, participant.names())),
               idl::TypeSupport<Request>::kDdsName, make_type_support<Request>(), idl::TypeSupport<Request>::kHash,
               kService, Writers::kMany),
        reply_(participant, reply_dds_name(full_name(service, participant.names())),
               idl::TypeSupport<Response>::kDdsName, make_type_support<Response>(), idl::TypeSupport<Response>::kHash,
               kService),
        handler_(std::move(handler)), every_call_counts_(service.every_call_counts) {}

  std::size_t dispatch(std::size_t most) override {
    const std::size_t room = kMostWaiting - waiting_.size();  // the others wait in the reader
    std::size_t count = take_each(std::min(most, room), &request_, [this](const auto& info) {
      waiting_.push_back({request_id(info), request_});
    });
    if (!waiting_.empty() && Clock::now() >= rested_) count += handle_oldest();
    send_replies();
    wake_for_requests(waiting_.size() < kMostWaiting);
    return count;
  }

  void finish() override {
    while (!waiting_.empty()) handle_oldest();
    send_replies();
  }

  std::optional<Clock::time_point> due() const override {
    return waiting_.empty() ? std::nullopt : std::optional(rested_);
  }

 private:
  static constexpr std::chrono::seconds kMatchingPatience{2};
  static constexpr std::size_t kMostWaiting = 100;

  struct Waiting {
    RequestId id;
    Request request;
  };
  struct Pending {
    RequestId id;
    Response response;
    Clock::time_point deadline;  // the reply waits until then for the client's reader to match
  };

  static RequestId request_id(const compat::fdds::SampleInfo& info) {
    RequestId id;
    id.identity = info.sample_identity;
    const auto& related = info.related_sample_identity.writer_guid();
    if (related != compat::rtps::GUID_t::unknown()) id.identity.writer_guid(related);
    id.client = to_gid(id.identity.writer_guid());
    return id;
  }

  /// Requests that wait in the reader must not wake the executor while nobody takes them: it would spin.
  void wake_for_requests(bool wanted) {
    using compat::fdds::StatusMask;
    condition().set_enabled_statuses(wanted ? StatusMask::data_available() : StatusMask::none());
  }

  /// Returns the number of requests that are answered.
  std::size_t handle_oldest() {
    const Request request = waiting_.front().request;
    const auto begin = Clock::now();
    const Response response = handler_(request);
    const auto end = Clock::now();
    rested_ = end + (end - begin);
    bool is_first = true;
    return std::erase_if(waiting_, [&](const Waiting& waiting) {
      if (!(waiting.request == request) || (every_call_counts_ && !std::exchange(is_first, false))) return false;
      pending_.push_back({waiting.id, response, end + kMatchingPatience});
      return true;
    });
  }

  // A VOLATILE writer loses a reply whose reader it has not matched yet; such replies wait for the match.
  void send_replies() {
    const auto now = Clock::now();
    std::erase_if(pending_, [this, now](Pending& pending) {
      const bool names_reader = (pending.id.client[15] & 0x04) != 0;  // entity kind of readers
      if (names_reader && !reply_.is_matched(pending.id.client) && now < pending.deadline) return false;
      compat::rtps::WriteParams params;
      params.related_sample_identity(pending.id.identity);
      reply_.write(&pending.response, params);
      return true;
    });
  }

  Writer reply_;
  Handler handler_;
  bool every_call_counts_;
  Request request_;
  std::deque<Waiting> waiting_;
  Clock::time_point rested_;  // when the next request may be handled
  std::vector<Pending> pending_;
};

/// Calls one service, with requests and responses of types that the two type supports serialise.
template <class Request, class Response>
class RequestClient : public Source {
 public:
  /// The name of a type on the wire, with what serialises it.
  struct Type {
    std::string dds_name;
    std::string hash;
    compat::fdds::TypeSupport support;
  };

  /// @param service name of the service as ROS 2 shows it
  RequestClient(Participant& participant, const std::string& service, const Type& request, const Type& response)
      : Source(participant, reply_dds_name(service), response.dds_name, response.support, response.hash, kService,
               Writers::kMany),
        request_(participant, request_dds_name(service), request.dds_name, request.support, request.hash, kService) {}

  /// True when a server's reader and writer are matched.
  bool is_ready() const { return matched() > 0 && request_.matched() > 0; }

  /// Sends a request; returns the number that its reply will carry, or nothing when DDS refused it.
  std::optional<std::uint64_t> call(const Request& request) {
    compat::rtps::WriteParams params;
    compat::rtps::SampleIdentity reply_to;
    reply_to.writer_guid(reader_guid());
    params.related_sample_identity(reply_to);
    if (!request_.write(&request, params)) return std::nullopt;
    return request_.written();
  }

  /// The reply to a call if it has arrived; each reply can be taken once.
  std::optional<Response> take_reply(std::uint64_t number) {
    const auto it = replies_.find(number);
    if (it == replies_.end()) return std::nullopt;
    Response response = std::move(it->second);
    replies_.erase(it);
    return response;
  }

  std::size_t dispatch(std::size_t most) override {
    return take_each(most, &response_, [this](const auto& info) {
      const Gid client = to_gid(info.related_sample_identity.writer_guid());
      const bool is_mine = client == gid() || client == request_.gid();  // all clients receive all replies
      if (is_mine) replies_[info.related_sample_identity.sequence_number().to64long()] = response_;
    });
  }

 private:
  compat::rtps::GUID_t reader_guid() const {
    compat::rtps::GUID_t guid;
    const Gid mine = gid();
    for (std::size_t i = 0; i < 12; ++i) guid.guidPrefix.value[i] = mine[i];
    for (std::size_t i = 0; i < 4; ++i) guid.entityId.value[i] = mine[12 + i];
    return guid;
  }

  Writer request_;
  Response response_;
  std::map<std::uint64_t, Response> replies_;
};

/// Calls one service of the table.
template <class Service>
class ServiceClient : public RequestClient<typename idl::ServiceSupport<Service>::Request,
                                           typename idl::ServiceSupport<Service>::Response> {
  using Request = typename idl::ServiceSupport<Service>::Request;
  using Response = typename idl::ServiceSupport<Service>::Response;
  using Base = RequestClient<Request, Response>;

 public:
  ServiceClient(Participant& participant, const ServiceTopic<Service>& service)
      : Base(participant, full_name(service, participant.names()), type_of<Request>(), type_of<Response>()) {}

 private:
  template <class Message>
  static typename Base::Type type_of() {
    using Support = idl::TypeSupport<Message>;
    return {Support::kDdsName, Support::kHash, make_type_support<Message>()};
  }
};

}  // namespace lapis::dds
