// SPDX-License-Identifier: BSD-3-Clause
// Reads bags of ROS, whatever their container. A bag holds the messages of some connections, each on a topic.
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

// kProtobuf and kJson: messages of Foxglove's own types, which read_message() converts to those of ROS 1.
enum class RosEncoding { kRos1, kCdr, kProtobuf, kJson, kOther };

struct BagConnection {
  std::string topic;
  std::string type;  // such as "sensor_msgs/Image", in ROS 2, too; any text if it is not read
  RosEncoding encoding = RosEncoding::kOther;

  bool has_images() const;
  bool has_calibration() const;
  bool has_transforms() const;  // transforms of frames (tf)
  bool is_read() const { return has_images() || has_calibration() || has_transforms(); }
};

// Returns the type as ROS 1 writes it: "sensor_msgs/Image" also for "sensor_msgs/msg/Image".
std::string type_named(const std::string& name);

// The place of a message's bytes. In SQLite, `at` is the number of its row.
struct BagPlace {
  static constexpr int32_t kInFile = -1;
  int32_t file = 0;         // number of the file, in a bag of several
  int32_t chunk = kInFile;  // number of the chunk in whose decompressed bytes `at` lies
  int64_t at = 0, bytes = 0;
};

// Number of bytes that scan() reads of each message: messages of images and some other types begin with the stamp of
// their header.
inline constexpr size_t kHeadBytes = 12;
struct BagMessage {
  uint32_t connection = 0;
  int64_t time_ns = 0;  // time of recording
  BagPlace place;
  std::array<uint8_t, kHeadBytes> head{};  // the message's first bytes; zeros behind its end
};

struct BagDamage {
  int64_t places = 0, bytes = 0;
  std::string first;   // describes the first place, with the file's name; empty if there is none
  std::string at_end;  // describes damage at the end of the file; may be empty
};

class BagFile {
 public:
  virtual ~BagFile() = default;
  // Calls `visit` for each message, in stored order, until it returns false; damage is skipped. Messages of types that
  // are not read need not be visited, but are counted. To be called once.
  using Visit = std::function<bool(const BagMessage&)>;
  virtual void scan(const Visit& visit) = 0;
  // Returns the connections that scan() has found.
  virtual const std::map<uint32_t, BagConnection>& connections() const = 0;
  virtual const std::map<uint32_t, int64_t>& other_messages() const = 0;  // messages not visited, by connection
  virtual const BagDamage& damage() const = 0;
  virtual int64_t size_bytes() const = 0;
  // Says why nothing of the bag can be read; empty if that is not known.
  virtual std::string refusal() const { return {}; }
  virtual std::vector<std::string> notes() const { return {}; }
  // Returns how many messages of a topic are missing, besides the `found` ones, because files of the bag are missing.
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
// Precondition: the path is a bag (kind_of_bag()).
std::unique_ptr<BagFile> open_bag_file(const std::string& path);

// Returns the time at which the file's first readable message was recorded; nullopt if there is none. Precondition: the
// file is a bag.
std::optional<int64_t> first_recorded_in_bag(const std::filesystem::path& file);

}  // namespace rumi
