// SPDX-License-Identifier: BSD-3-Clause
// The folder of a ROS 2 bag: the files that its metadata.yaml lists, one behind the other.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "base/natural_order.h"
#include "camera_driver/recording/bag/bag_file.h"

namespace rumi::camera_driver {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostFiles = 100'000;

// Their names, as far as they are listed; nothing if metadata.yaml is broken.
std::optional<std::vector<std::string>> listed_files(const fs::path& folder) {
  try {
    const YAML::Node root = YAML::LoadFile((folder / "metadata.yaml").string());
    std::vector<std::string> names;
    for (const YAML::Node& file : root["rosbag2_bagfile_information"]["relative_file_paths"]) {
      if (names.size() == kMostFiles) break;
      // Some versions name the folder, too.
      names.push_back(fs::path(file.as<std::string>()).filename().string());
    }
    return names;
  } catch (const YAML::Exception&) {
    return std::nullopt;
  }
}

std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code))
    if (it->path().extension() == ".db3" || it->path().extension() == ".mcap")
      names.push_back(it->path().filename().string());
  std::sort(names.begin(), names.end(), natural_less);
  return names;
}

class BagFolder : public BagFile {
 public:
  explicit BagFolder(const std::string& folder) : folder_(folder) {
    std::optional<std::vector<std::string>> names = listed_files(folder_);
    if (!names || names->empty()) {
      names = files_in(folder_);
      notes_.push_back("its metadata.yaml lists no files: all that are there are read");
    }
    for (const std::string& name : *names) add_file(name);
    if (files_.empty() && refusal_.empty())
      refusal_ = "is the folder of a ROS 2 bag, but none of its files (.db3 or .mcap) is in it";
  }

  void scan(const std::function<void(const BagMessage&)>& visit) override {
    for (size_t i = 0; i < files_.size(); ++i) {
      files_[i]->scan([&](BagMessage message) {
        message.connection = number_of(i, message.connection);
        message.place.file = static_cast<int32_t>(i);
        visit(message);
      });
      for (const auto& [id, connection] : files_[i]->connections()) connections_[number_of(i, id)] = connection;
      for (const auto& [id, count] : files_[i]->other_messages()) other_messages_[number_of(i, id)] += count;
      add_damage(files_[i]->damage());
      if (refusal_.empty()) refusal_ = files_[i]->refusal();
    }
  }
  const std::map<uint32_t, BagConnection>& connections() const override { return connections_; }
  const std::map<uint32_t, int64_t>& other_messages() const override { return other_messages_; }
  const BagDamage& damage() const override { return damage_; }
  int64_t size_bytes() const override {
    int64_t bytes = 0;
    for (const auto& file : files_) bytes += file->size_bytes();
    return bytes;
  }
  std::string refusal() const override { return refusal_; }
  std::vector<std::string> notes() const override { return notes_; }
  bool read(const BagPlace& place, std::vector<uint8_t>* bytes) override {
    return files_[static_cast<size_t>(place.file)]->read(place, bytes);
  }

 private:
  void add_file(const std::string& name) {
    const fs::path file = folder_ / name, unpacked = folder_ / fs::path(name).stem();
    std::error_code code;
    if (fs::is_regular_file(file, code) && file.extension() != ".zstd") {
      open(file);
    } else if (file.extension() == ".zstd" && fs::is_regular_file(unpacked, code)) {
      open(unpacked);
    } else if (file.extension() == ".zstd") {
      refusal_ = fmt::format("its files are packed: unpack them (`unzstd {}/*.zstd`) and give the folder again",
                             folder_.string());
    } else {
      notes_.push_back(fmt::format("{} is not there, which its metadata.yaml lists: the rest is played", name));
    }
  }
  void open(const fs::path& file) {
    const bool is_sqlite = kind_of_bag(file.string()) == BagKind::kSqlite;
    files_.push_back(is_sqlite ? open_ros2_sqlite(file.string()) : open_mcap_file(file.string()));
  }
  uint32_t number_of(size_t file, uint32_t connection) {
    return numbers_.try_emplace({file, connection}, static_cast<uint32_t>(numbers_.size())).first->second;
  }
  void add_damage(const BagDamage& more) {
    if (damage_.places == 0) damage_.first = more.first;
    damage_.places += more.places;
    damage_.bytes += more.bytes;
    if (damage_.at_end.empty()) damage_.at_end = more.at_end;
  }

  fs::path folder_;
  std::vector<std::unique_ptr<BagFile>> files_;
  std::vector<std::string> notes_;
  std::string refusal_;
  std::map<std::pair<size_t, uint32_t>, uint32_t> numbers_;
  std::map<uint32_t, BagConnection> connections_;
  std::map<uint32_t, int64_t> other_messages_;
  BagDamage damage_;
};

}  // namespace

std::unique_ptr<BagFile> open_bag_folder(const std::string& folder) { return std::make_unique<BagFolder>(folder); }

}  // namespace rumi::camera_driver
