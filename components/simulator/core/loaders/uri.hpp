#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lapis::simulator {

/// Replaces %XX by the byte that it stands for; anything else stays as it is [RFC 3986, section 2.1].
std::string decode_percent(std::string_view uri);

/// Bytes of "data:...;base64,..." [RFC 2397, RFC 4648]; nothing when the URI has another form.
std::optional<std::vector<std::uint8_t>> decode_data_uri(std::string_view uri);

}  // namespace lapis::simulator
