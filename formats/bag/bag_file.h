// SPDX-License-Identifier: BSD-3-Clause
// A bag of ROS, whatever its container: messages of some connections, each on a topic.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rumi {

// Protobuf and JSON: of Foxglove's own types, which read_message() turns into those of ROS 1.
enum class RosEncoding { kRos1, kCdr, kProtobuf, kJson, kOther };

struct BagConnection {
  std::string topic;
  std::string type;  // "sensor_msgs/Image", of ROS 2, too; of others as it is
  RosEncoding encoding = RosEncoding::kOther;

  bool has_images() const;
  bool has_calibration() const;
  bool has_transforms() const;  // transforms of frames (tf)
  bool is_read() const { return has_images() || has_calibration() || has_transforms(); }
};

// "sensor_msgs/msg/Image" and "sensor_msgs/Image" are the same.
std::string type_named(const std::string& name);

// The place of a message's bytes.
struct BagPlace {
  static constexpr int32_t kInFile = -1;
  int32_t file = 0;         // number of the file, in a bag of several
  int32_t chunk = kInFile;  // the decompressed chunk in which `at` counts
  int64_t at = 0, bytes = 0;
};

// For images and some other types: a message begins with the stamp of its header.
inline constexpr size_t kHeadBytes = 12;
struct BagMessage {
  uint32_t connection = 0;
  int64_t time_ns = 0;  // when it was recorded
  BagPlace place;
  std::array<uint8_t, kHeadBytes> head{};  // zeros behind the message's end
};

struct BagDamage {
  int64_t places = 0, bytes = 0;
  std::string first;   // the first place, with the file's name; empty if there is none
  std::string at_end;  // the damage at the end of the file; may be empty
};

class BagFile {
 public:
  virtual ~BagFile() = default;
  // Calls `visit` for each message in the order in which they are stored, until it returns false; damage is skipped.
  // Messages of types that are not read need not be visited, but are counted. To be called once.
  using Visit = std::function<bool(const BagMessage&)>;
  virtual void scan(const Visit& visit) = 0;
  // The connections that scan() has found.
  virtual const std::map<uint32_t, BagConnection>& connections() const = 0;
  virtual const std::map<uint32_t, int64_t>& other_messages() const = 0;  // those that were not visited
  virtual const BagDamage& damage() const = 0;
  virtual int64_t size_bytes() const = 0;
  // Says why nothing of the bag can be read; empty if that is not known.
  virtual std::string refusal() const { return {}; }
  virtual std::vector<std::string> notes() const { return {}; }
  // If files of the bag are missing: how many messages of a topic should be there besides the `found` ones.
  virtual int64_t missing_messages(const std::string& /*topic*/, int64_t /*found*/) const { return 0; }
  virtual bool read(const BagPlace& place, std::vector<uint8_t>* bytes) = 0;
};

enum class BagKind { kNone, kRos1, kMcap, kSqlite, kFolder };
// Judges a file by its beginning, else by its name, and a folder by its metadata.yaml or the parts in it.
BagKind kind_of_bag(const std::string& path);
std::unique_ptr<BagFile> open_ros1_bag(const std::string& file);
std::unique_ptr<BagFile> open_mcap_file(const std::string& file);
std::unique_ptr<BagFile> open_ros2_sqlite(const std::string& file);
std::unique_ptr<BagFile> open_bag_folder(const std::string& folder);
// Precondition: it is a bag.
std::unique_ptr<BagFile> open_bag_file(const std::string& path);

// The time at which its first readable message was recorded; nothing if there is none. Precondition: the file is a bag.
std::optional<int64_t> first_recorded_in_bag(const std::filesystem::path& file);

}  // namespace rumi
