// SPDX-License-Identifier: BSD-3-Clause
// Reads a bag that is a folder of parts, one after the other: those that ROS 2's metadata.yaml lists, or, without it,
// the bags whose names differ only in numbers.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "base/text/natural_order.h"
#include "formats/bag/bag_file.h"
#include "formats/recording/recording_parts.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostFiles = 100'000;

struct Metadata {
  std::vector<std::string> files;           // names of the bag's files, as it lists them
  std::map<std::string, int64_t> messages;  // messages on each topic
};

// Reads metadata.yaml. If it is broken, the result is what could be read before the fault.
Metadata read_metadata(const fs::path& folder) {
  Metadata metadata;
  try {
    const YAML::Node information = YAML::LoadFile((folder / "metadata.yaml").string())["rosbag2_bagfile_information"];
    for (const YAML::Node& file : information["relative_file_paths"]) {
      if (metadata.files.size() == kMostFiles) break;
      // Some versions write the folder's name before that of the file.
      metadata.files.push_back(fs::path(file.as<std::string>()).filename().string());
    }
    for (const YAML::Node& topic : information["topics_with_message_count"])
      metadata.messages[topic["topic_metadata"]["name"].as<std::string>()] += topic["message_count"].as<int64_t>();
  } catch (const YAML::Exception&) {
    return metadata;
  }
  return metadata;
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
    std::error_code code;
    if (fs::exists(folder_ / "metadata.yaml", code)) {
      open_listed();
    } else {
      for (const fs::path& part : parts_in(folder_)) add_file(part.filename().string());
      notes_.push_back(
          fmt::format("its {} files are played as one recording, in the order of their numbers", files_.size()));
    }
    if (files_.empty() && refusal_.empty())
      refusal_ = "is the folder of a ROS 2 bag, but none of its files (.db3 or .mcap) is in it";
  }

  void scan(const Visit& visit) override {
    std::vector<PartTimes> parts;
    bool goes_on = true;
    for (size_t i = 0; goes_on && i < files_.size(); ++i) {
      std::optional<PartTimes> part;
      files_[i]->scan([&](BagMessage message) {
        const int64_t time_us = message.time_ns / 1000;
        if (!part) part = {names_[i], time_us, time_us};
        part->first_us = std::min(part->first_us, time_us);
        part->last_us = std::max(part->last_us, time_us);
        message.connection = number_of(i, message.connection);
        message.place.file = static_cast<int32_t>(i);
        return goes_on = visit(message);
      });
      if (part) parts.push_back(std::move(*part));
      for (const auto& [id, connection] : files_[i]->connections()) connections_[number_of(i, id)] = connection;
      for (const auto& [id, count] : files_[i]->other_messages()) other_messages_[number_of(i, id)] += count;
      add_damage(files_[i]->damage());
      if (refusal_.empty()) refusal_ = files_[i]->refusal();
    }
    if (refusal_.empty() && !is_listed_) refusal_ = why_not_one_recording(parts);
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
  int64_t missing_messages(const std::string& topic, int64_t found) const override {
    if (missing_files_ == 0) return 0;
    if (const auto listed = listed_messages_.find(topic); listed != listed_messages_.end())
      return std::max<int64_t>(0, listed->second - found);
    // Assumes that a missing file has as many messages of the topic as the present files have on average, and at least
    // one.
    return std::max(missing_files_, missing_files_ * found / static_cast<int64_t>(files_.size()));
  }
  bool read(const BagPlace& place, std::vector<uint8_t>* bytes) override {
    return files_[static_cast<size_t>(place.file)]->read(place, bytes);
  }

 private:
  void open_listed() {
    Metadata metadata = read_metadata(folder_);
    const std::vector<std::string> there = files_in(folder_);
    is_listed_ = !metadata.files.empty();
    if (!is_listed_) notes_.push_back("its metadata.yaml lists no files: all that are there are read");
    for (const std::string& name : is_listed_ ? metadata.files : there) add_file(name);
    listed_messages_ = std::move(metadata.messages);
    for (const std::string& name : there)
      if (is_listed_ && std::find(names_.begin(), names_.end(), name) == names_.end())
        notes_.push_back(fmt::format(
            "{} is in it and not played, because its metadata.yaml does not list it: `ros2 bag reindex` does", name));
  }
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
      ++missing_files_;
    }
  }
  void open(const fs::path& file) {
    files_.push_back(open_bag_file(file.string()));
    names_.push_back(file.filename().string());
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
  std::vector<std::string> names_;                  // names of files_
  bool is_listed_ = false;                          // metadata.yaml lists the files
  int64_t missing_files_ = 0;                       // listed files that are not there
  std::map<std::string, int64_t> listed_messages_;  // messages on each topic
  std::vector<std::string> notes_;
  std::string refusal_;
  std::map<std::pair<size_t, uint32_t>, uint32_t> numbers_;
  std::map<uint32_t, BagConnection> connections_;
  std::map<uint32_t, int64_t> other_messages_;
  BagDamage damage_;
};

}  // namespace

std::unique_ptr<BagFile> open_bag_folder(const std::string& folder) { return std::make_unique<BagFolder>(folder); }

}  // namespace rumi
