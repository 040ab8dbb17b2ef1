// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag_writer/ros_types.h"

#include <map>
#include <set>
#include <sstream>
#include <vector>

namespace rumi {
namespace {

// ROS 2 requires small letters in the names of members, and its header has no sequence number.
struct Definition {
  std::string text;
  std::string of_ros1;  // text in ROS 1, if it differs; else empty
  std::string md5;      // checksum in ROS 1; only of types that are written
};

const std::map<std::string, Definition>& definitions() {
  static const std::map<std::string, Definition> kDefinitions = {
      {"builtin_interfaces/Time", {"int32 sec\nuint32 nanosec\n", "", ""}},
      {"std_msgs/Header",
       {"builtin_interfaces/Time stamp\nstring frame_id\n", "uint32 seq\ntime stamp\nstring frame_id\n", ""}},
      {kImageType,
       {"std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
        "uint8[] data\n",
        "", "060021388200f6f0f447d0fcd9c64743"}},
      {kCompressedImageType,
       {"std_msgs/Header header\nstring format\nuint8[] data\n", "", "8f7a12909da2c9d3332d540a0977563f"}},
      {kCameraInfoType,
       {"std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\n"
        "float64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n",
        "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] D\nfloat64[9] K\n"
        "float64[9] R\nfloat64[12] P\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n",
        "c9a58c1b0b154e0e6da7578cb991d214"}},
      {"sensor_msgs/RegionOfInterest",
       {"uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n", "", ""}},
      {"geometry_msgs/Point", {"float64 x\nfloat64 y\nfloat64 z\n", "", ""}},
      {"geometry_msgs/Vector3", {"float64 x\nfloat64 y\nfloat64 z\n", "", ""}},
      {"geometry_msgs/Quaternion", {"float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n", "", ""}},
      {"geometry_msgs/Pose", {"geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n", "", ""}},
      {kPoseType, {"std_msgs/Header header\ngeometry_msgs/Pose pose\n", "", "d3812c3cbc69362b77dc0b19b345f8f5"}},
      {kPathType,
       {"std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n", "", "6227e2b7e9cce15051f669a5e197bbf7"}},
      {"geometry_msgs/Transform", {"geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n", "", ""}},
      {"geometry_msgs/TransformStamped",
       {"std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n", "", ""}},
      {kTransformsType, {"geometry_msgs/TransformStamped[] transforms\n", "", "94810edda583a504dfda3829e70d7eec"}},
  };
  return kDefinitions;
}

const std::string& text_of(const std::string& type, Ros ros) {
  const Definition& definition = definitions().at(type);
  return ros == Ros::k1 && !definition.of_ros1.empty() ? definition.of_ros1 : definition.text;
}

// Adds the types of the members of `type`, and of their members, each once.
void add_parts(const std::string& type, Ros ros, std::vector<std::string>* parts, std::set<std::string>* known) {
  std::istringstream lines(text_of(type, ros));
  for (std::string member; std::getline(lines, member);) {
    const std::string part = member.substr(0, member.find_first_of("[ "));
    if (part.find('/') == std::string::npos || !known->insert(part).second) continue;
    parts->push_back(part);
    add_parts(part, ros, parts, known);
  }
}

}  // namespace

std::string definition_of(const std::string& type, Ros ros) {
  std::vector<std::string> parts;
  std::set<std::string> known = {type};
  add_parts(type, ros, &parts, &known);
  std::string text = text_of(type, ros);
  constexpr size_t kLineLength = 80;
  for (const std::string& part : parts)
    text.append(kLineLength, '=').append("\nMSG: ").append(part).append("\n").append(text_of(part, ros));
  return text;
}

std::string md5_of(const std::string& type) { return definitions().at(type).md5; }

std::string full_name(const std::string& type, Ros ros) {
  const size_t slash = type.find('/');
  return ros == Ros::k1 ? type : type.substr(0, slash) + "/msg" + type.substr(slash);
}

}  // namespace rumi
