// SPDX-License-Identifier: BSD-3-Clause
// A bag of ROS that is being written. It appears whole, with its index, at close(), or not at all.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "base/result.h"
#include "formats/bag_writer/ros_types.h"

namespace rumi {

class BagWriter {
 public:
  explicit BagWriter(Ros ros) : ros_(ros) {}
  virtual ~BagWriter() = default;
  Ros ros() const { return ros_; }

  // All messages of a topic must have the same type. Failures are kept for so_far() and close().
  virtual void write(const std::string& topic, const std::string& type, int64_t time_ns,
                     const std::string& message) = 0;
  // An Error names the file and why it could not be written.
  virtual const Result<>& so_far() const = 0;
  virtual Result<> close() = 0;

 private:
  Ros ros_;
};

// Messages are collected up to this size, and written with an index: damage costs no more than what is in one chunk.
inline constexpr size_t kChunkBytes = size_t{768} << 10;  // as rosbag does it

// Writes for ROS 2 and Foxglove: mcap.dev/spec, chunks compressed by zstd, messages in CDR.
std::unique_ptr<BagWriter> write_mcap_file(const std::string& file);
// Writes for ROS 1: wiki.ros.org/Bags/Format/2.0, chunks uncompressed, which every reader can read.
std::unique_ptr<BagWriter> write_ros1_bag(const std::string& file);

}  // namespace rumi
