#include "unit/simulator/assets/asset_files.hpp"

#include <zip.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace lapis::simulator::test {

Bytes to_bytes(std::string_view text) { return {text.begin(), text.end()}; }

void write_file(const std::filesystem::path& file, const Bytes& bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
}

Bytes read_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_zip(const std::filesystem::path& file, const Files& files, const std::string& password) {
  zip_t* const archive = zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  if (archive == nullptr) throw std::runtime_error("cannot make " + file.string());
  for (const auto& [name, bytes] : files) {
    if (name.ends_with('/')) {
      zip_dir_add(archive, name.c_str(), 0);
      continue;
    }
    zip_source_t* const source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
    const auto index = zip_file_add(archive, name.c_str(), source, 0);
    if (!password.empty())
      zip_file_set_encryption(archive, static_cast<zip_uint64_t>(index), ZIP_EM_AES_256, password.c_str());
  }
  if (zip_close(archive) != 0) throw std::runtime_error("cannot write " + file.string());
}

std::optional<Bytes> MemoryStore::read(const std::string& name) const {
  const auto found = files_.find(name);
  if (found == files_.end()) return std::nullopt;
  return found->second;
}

std::vector<std::string> MemoryStore::names() const {
  std::vector<std::string> result;
  for (const auto& [name, bytes] : files_) result.push_back(name);
  return result;
}

Bytes png(int width, int height, Rgba8 color) {
  Bytes bytes;
  cv::imencode(".png", cv::Mat(height, width, CV_8UC4, cv::Scalar(color.b, color.g, color.r, color.a)), bytes);
  return bytes;
}

}  // namespace lapis::simulator::test
