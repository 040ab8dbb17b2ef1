// SPDX-License-Identifier: BSD-3-Clause
// Writes a bag of ROS. The file appears whole, with its index, at close(), or not at all.
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

// Messages are collected into chunks of at most this size, each with an index: damage costs no more than one chunk.
inline constexpr size_t kChunkBytes = size_t{768} << 10;  // bytes, as in rosbag

// Writes for ROS 2 and Foxglove: mcap.dev/spec, chunks compressed by zstd, messages in CDR.
std::unique_ptr<BagWriter> write_mcap_file(const std::string& file);
// Writes for ROS 1: wiki.ros.org/Bags/Format/2.0, chunks uncompressed, which every reader can read.
std::unique_ptr<BagWriter> write_ros1_bag(const std::string& file);

}  // namespace rumi
