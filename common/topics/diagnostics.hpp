#pragma once

#include "common/dds/topic.hpp"
#include "idl/diagnostic_msgs.hpp"

namespace lapis::topics {

// What every process except the supervisor publishes.
inline constexpr dds::Topic<diagnostic_msgs::msg::DiagnosticArray> kDiagnostics{
    "/diagnostics",
    dds::kState,
    "all but the supervisor",
    "1 Hz and on change",
    "health, counters, CPU time and memory of the process",
    true,
    true};

}  // namespace lapis::topics
