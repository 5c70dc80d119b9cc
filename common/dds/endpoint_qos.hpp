#pragma once

#include <string>

#include "common/dds/compat.hpp"
#include "common/dds/link.hpp"
#include "common/dds/qos.hpp"

namespace lapis::dds {

/// The QoS of a writer or reader with every policy set explicitly; `type_hash` becomes the user data that ROS 2 shows.
compat::fdds::DataWriterQos writer_qos(const Qos& wanted, const std::string& type_hash,
                                       const LinkSettings& link = kLoopbackLink);
compat::fdds::DataReaderQos reader_qos(const Qos& wanted, const std::string& type_hash,
                                       const LinkSettings& link = kLoopbackLink);

/// The flow controller that paces the writers of large samples in a participant with these settings.
inline constexpr const char* kPaceName = "large";

}  // namespace lapis::dds
