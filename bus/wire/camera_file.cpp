// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/camera_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>

namespace rumi {
namespace {

// A calibration also comes with every image from the network; the longest real files are a few kB.
constexpr size_t kMaxBytes = 65536;

// The scalar as it stands in the file, cut short for messages.
std::string quoted(const YAML::Node& node) {
  if (!node.IsScalar()) return node.IsMap() ? "a group" : node.IsSequence() ? "a list" : "empty";
  const std::string& text = node.Scalar();
  return text.size() > 40 ? fmt::format("'{}...'", text.substr(0, 40)) : fmt::format("'{}'", text);
}

std::optional<double> parse_number(const std::string& text) {
  const char* first = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* last = text.data() + text.size();
  double value = 0;
  const auto [end, code] = std::from_chars(first, last, value);
  if (code != std::errc() || end != last || first == last) return std::nullopt;
  return value;
}

// Reads fields and keeps the first error, so that the formats below can be written without a check after every line.
class Reader {
 public:
  explicit Reader(std::string name) : name_(std::move(name)) {}

  const std::string& error() const { return error_; }
  void fail(const std::string& what) {
    if (error_.empty()) error_ = fmt::format("{}: {}", name_, what);
  }

  double number(const YAML::Node& node, const std::string& field, const std::string& meaning) {
    if (!node.IsDefined() || node.IsNull()) {
      fail(fmt::format("{} is missing: add '{}: <{}>'", field, field, meaning));
      return 0;
    }
    const std::optional<double> value = node.IsScalar() ? parse_number(node.Scalar()) : std::nullopt;
    if (!value || !std::isfinite(*value)) {
      fail(fmt::format("{} is {}: must be a finite number ({})", field, quoted(node), meaning));
      return 0;
    }
    return *value;
  }
  double optional_number(const YAML::Node& node, const std::string& field) {
    return node.IsDefined() && !node.IsNull() ? number(node, field, "a distortion coefficient or rate") : 0;
  }
  int size(const YAML::Node& node, const std::string& field) {
    const double value = number(node, field, "pixels");
    if (value != std::floor(value) || std::abs(value) > 1e6) {
      fail(fmt::format("{} is {}: must be a whole number of pixels", field, quoted(node)));
      return 0;
    }
    return static_cast<int>(value);
  }
  std::string text(const YAML::Node& node, const std::string& otherwise) {
    return node.IsDefined() && node.IsScalar() ? node.Scalar() : otherwise;
  }
  std::vector<double> list(const YAML::Node& node, const std::string& field, const std::string& meaning) {
    std::vector<double> values;
    if (!node.IsDefined() || node.IsNull()) {
      fail(fmt::format("{} is missing: add '{}: [{}]'", field, field, meaning));
    } else if (!node.IsSequence()) {
      fail(fmt::format("{} is {}: must be a list [{}]", field, quoted(node), meaning));
    } else {
      for (size_t i = 0; i < node.size(); ++i)
        values.push_back(number(node[i], fmt::format("{}[{}]", field, i), meaning));
    }
    return values;
  }
  std::vector<double> list(const YAML::Node& node, const std::string& field, const std::string& meaning, size_t count) {
    std::vector<double> values = list(node, field, meaning);
    if (error_.empty() && values.size() != count)
      fail(fmt::format("{} has {} values: must have {} ({})", field, values.size(), count, meaning));
    values.resize(count);
    return values;
  }

 private:
  std::string name_, error_;
};

// node[key] for a node that may be missing or not a map (yaml-cpp throws for some of these).
YAML::Node child(const YAML::Node& node, const std::string& key) {
  return node.IsDefined() && node.IsMap() ? node[key] : YAML::Node(YAML::NodeType::Undefined);
}

// The first of several spellings that is there.
YAML::Node any_of(const YAML::Node& root, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (root[key]) return root[key];
  return YAML::Node(YAML::NodeType::Undefined);
}

void set_intrinsics(const std::vector<double>& fx_fy_cx_cy, Camera* camera) {
  camera->fx = fx_fy_cx_cy[0];
  camera->fy = fx_fy_cx_cy[1];
  camera->cx = fx_fy_cx_cy[2];
  camera->cy = fx_fy_cx_cy[3];
}

void read_matrix(Reader& in, const YAML::Node& matrix, const std::string& field, Camera* camera) {
  const std::vector<double> k = in.list(child(matrix, "data"), field + ".data", "fx, 0, cx, 0, fy, cy, 0, 0, 1", 9);
  if (k[1] != 0 || k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1)
    in.fail(field + ".data is not of the form [fx, 0, cx, 0, fy, cy, 0, 0, 1] (row by row; skew is not supported)");
  set_intrinsics({k[0], k[4], k[2], k[5]}, camera);
}

void set_fisheye(Reader& in, const std::vector<double>& d, const std::string& field, Camera* camera) {
  camera->model = Camera::Model::kKannalaBrandt;
  if (d.size() != 4)
    return in.fail(fmt::format("{} has {} values: the equidistant model has 4 (k1 k2 k3 k4)", field, d.size()));
  camera->k1 = d[0], camera->k2 = d[1], camera->k3 = d[2], camera->k4 = d[3];
}

// OpenCV's order: k1 k2 p1 p2 [k3 [k4 k5 k6 [...]]]. What we have no model for must be zero.
void set_radial_tangential(Reader& in, const std::vector<double>& d, const std::string& field, Camera* camera) {
  camera->model = Camera::Model::kPinhole;
  if (d.empty()) return;
  if (d.size() < 4) return in.fail(fmt::format("{} has {} values: must have 4 or 5 (k1 k2 p1 p2 k3)", field, d.size()));
  camera->k1 = d[0], camera->k2 = d[1], camera->p1 = d[2], camera->p2 = d[3];
  if (d.size() > 4) camera->k3 = d[4];
  for (size_t i = 5; i < d.size(); ++i) {
    if (d[i] == 0) continue;
    const std::string name = i < 8 ? fmt::format("k{}", i - 1) : "thin prism or tilt";
    return in.fail(
        fmt::format("{}[{}] ({}) is {:.6g}: the rational model is not supported; calibrate again with k1 k2 p1 p2 k3 "
                    "only (plumb_bob), "
                    "or rectify the images and give the rectified camera",
                    field, i, name, d[i]));
  }
}

void refuse_model(Reader& in, const std::string& field, const std::string& value, const std::string& known) {
  in.fail(fmt::format("{} is '{}': supported are {}; calibrate with one of these, or rectify the images", field, value,
                      known));
}

void read_rumi(Reader& in, const YAML::Node& root, Camera* camera) {
  static const std::set<std::string> kKeys = {"model", "fx", "fy", "cx", "cy",    "k1",     "k2",
                                              "p1",    "p2", "k3", "k4", "width", "height", "fps"};
  std::set<std::string> seen;
  for (const auto& entry : root) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
    // A misspelt coefficient would silently count as zero.
    if (!kKeys.contains(key))
      return in.fail(fmt::format("{} is not known: the keys are model fx fy cx cy k1 k2 p1 p2 k3 (k4) width height fps",
                                 quoted(entry.first)));
    if (!seen.insert(key).second) return in.fail(fmt::format("{} is given twice: remove one", key));
  }
  const std::string model = in.text(root["model"], "pinhole");
  const bool fisheye = model == "kannala_brandt" || model == "fisheye";
  if (!fisheye && model != "pinhole")
    return refuse_model(in, "model", model, "pinhole and kannala_brandt (or fisheye)");
  camera->model = fisheye ? Camera::Model::kKannalaBrandt : Camera::Model::kPinhole;
  camera->width = in.size(root["width"], "width");
  camera->height = in.size(root["height"], "height");
  const std::pair<const char*, double*> required[] = {
      {"fx", &camera->fx}, {"fy", &camera->fy}, {"cx", &camera->cx}, {"cy", &camera->cy}};
  for (const auto& [key, value] : required) *value = in.number(root[key], key, "pixels");
  const std::pair<const char*, double*> others[] = {{"k1", &camera->k1},  {"k2", &camera->k2}, {"p1", &camera->p1},
                                                    {"p2", &camera->p2},  {"k3", &camera->k3}, {"k4", &camera->k4},
                                                    {"fps", &camera->fps}};
  for (const auto& [key, value] : others) *value = in.optional_number(root[key], key);
  if (!fisheye && camera->k4 != 0) in.fail(fmt::format("k4 is {:.6g}: only model kannala_brandt has it", camera->k4));
  if (fisheye && (camera->p1 != 0 || camera->p2 != 0))
    in.fail("p1 or p2 is not 0: model kannala_brandt has k1 k2 k3 k4");
}

void read_ros(Reader& in, const YAML::Node& root, Camera* camera) {
  camera->width = in.size(root["image_width"], "image_width");
  camera->height = in.size(root["image_height"], "image_height");
  read_matrix(in, root["camera_matrix"], "camera_matrix", camera);
  const std::string model = in.text(root["distortion_model"], "plumb_bob");
  const std::string field = "distortion_coefficients.data";
  const std::vector<double> d = in.list(child(root["distortion_coefficients"], "data"), field, "k1, k2, p1, p2, k3");
  if (model == "equidistant" || model == "fisheye") return set_fisheye(in, d, field, camera);
  if (model == "plumb_bob" || model == "rational_polynomial") return set_radial_tangential(in, d, field, camera);
  refuse_model(in, "distortion_model", model, "plumb_bob, equidistant and rational_polynomial with k4 = k5 = k6 = 0");
}

void read_opencv(Reader& in, const YAML::Node& root, Camera* camera) {
  camera->width = in.size(any_of(root, {"image_width", "image_Width", "width"}), "image_width");
  camera->height = in.size(any_of(root, {"image_height", "image_Height", "height"}), "image_height");
  read_matrix(in, any_of(root, {"camera_matrix", "Camera_Matrix"}), "camera_matrix", camera);
  const std::string field = "distortion_coefficients.data";
  const YAML::Node node = any_of(root, {"distortion_coefficients", "Distortion_Coefficients"});
  const std::vector<double> d = in.list(child(node, "data"), field, "k1, k2, p1, p2, k3");
  // Only the key written by OpenCV's calibration sample tells fisheye from pinhole.
  const bool fisheye = in.optional_number(root["fisheye_model"], "fisheye_model") != 0;
  fisheye ? set_fisheye(in, d, field, camera) : set_radial_tangential(in, d, field, camera);
}

// Kalibr's cam0 and EuRoC's sensor.yaml share all but the names of the distortion.
void read_kalibr(Reader& in, const YAML::Node& cam, const std::string& prefix, const char* coefficients,
                 Camera* camera) {
  const std::string type = in.text(cam["camera_model"], "pinhole");
  if (type != "pinhole") return refuse_model(in, prefix + "camera_model", type, "pinhole");
  set_intrinsics(in.list(cam["intrinsics"], prefix + "intrinsics", "fx, fy, cx, cy", 4), camera);
  const std::vector<double> size = in.list(cam["resolution"], prefix + "resolution", "width, height", 2);
  if (!in.error().empty()) return;
  camera->width = in.size(cam["resolution"][0], prefix + "resolution[0]");
  camera->height = in.size(cam["resolution"][1], prefix + "resolution[1]");
  const std::string model = in.text(cam["distortion_model"], "none");
  if (model != "none") {
    const std::string field = prefix + coefficients;
    const std::vector<double> d = in.list(cam[coefficients], field, "k1, k2, p1, p2");
    if (model == "equidistant") {
      set_fisheye(in, d, field, camera);
    } else if (model == "radtan" || model == "radial-tangential" || model == "plumb_bob") {
      set_radial_tangential(in, d, field, camera);
    } else {
      refuse_model(in, prefix + "distortion_model", model, "radtan (radial-tangential), equidistant and none");
    }
  }
  camera->fps = in.optional_number(cam["rate_hz"], prefix + "rate_hz");
}

// ORB-SLAM2 and 3: "Camera.fx", since ORB-SLAM3 1.0 "Camera1.fx".
void read_orbslam(Reader& in, const YAML::Node& root, Camera* camera) {
  const std::string prefix = root["Camera1.fx"] ? "Camera1." : "Camera.";
  camera->width = in.size(root["Camera.width"], "Camera.width");
  camera->height = in.size(root["Camera.height"], "Camera.height");
  const std::pair<const char*, double*> required[] = {
      {"fx", &camera->fx}, {"fy", &camera->fy}, {"cx", &camera->cx}, {"cy", &camera->cy}};
  for (const auto& [key, value] : required) *value = in.number(root[prefix + key], prefix + key, "pixels");
  const auto coefficient = [&](const char* key) { return in.optional_number(root[prefix + key], prefix + key); };
  const std::string type = in.text(root["Camera.type"], "PinHole");
  if (type == "KannalaBrandt8") {
    set_fisheye(in, {coefficient("k1"), coefficient("k2"), coefficient("k3"), coefficient("k4")}, "", camera);
  } else if (type == "PinHole" || type == "Pinhole") {
    set_radial_tangential(
        in, {coefficient("k1"), coefficient("k2"), coefficient("p1"), coefficient("p2"), coefficient("k3")}, "",
        camera);
  } else if (type != "Rectified") {
    refuse_model(in, "Camera.type", type, "PinHole, KannalaBrandt8 and Rectified");
  }
  camera->fps = in.optional_number(root["Camera.fps"], "Camera.fps");
}

std::string read_any(Reader& in, const YAML::Node& root, Camera* camera) {
  const YAML::Node matrix = any_of(root, {"camera_matrix", "Camera_Matrix"});
  if (root["Camera.fx"] || root["Camera1.fx"]) return read_orbslam(in, root, camera), "ORB-SLAM3";
  if (matrix.IsDefined()) {
    // Only FileStorage matrices have an element type.
    if (child(matrix, "dt").IsDefined()) return read_opencv(in, root, camera), "OpenCV";
    return read_ros(in, root, camera), "ROS camera_info";
  }
  if (root["cam0"] && root["cam0"].IsMap())
    return read_kalibr(in, root["cam0"], "cam0.", "distortion_coeffs", camera), "Kalibr";
  if (root["intrinsics"]) return read_kalibr(in, root, "", "distortion_coefficients", camera), "EuRoC";
  return read_rumi(in, root, camera), "rumi";
}

// OpenCV's "%YAML:1.0" is not a directive that a YAML parser knows.
std::string without_directive(const std::string& text) {
  if (!text.starts_with("%YAML")) return text;
  const size_t end = text.find('\n');
  return end == std::string::npos ? std::string() : text.substr(end);
}

constexpr const char* kExpected =
    "expected our YAML (fx: 525 ... width: 640, see config/cameras) or that of ROS camera_info, Kalibr, OpenCV, EuRoC "
    "or "
    "ORB-SLAM";

}  // namespace

CameraFileResult parse_camera(const std::string& yaml_text, const std::string& name) {
  CameraFileResult result;
  Reader in(name);
  if (yaml_text.size() > kMaxBytes) {
    in.fail(fmt::format("is {} bytes long: not a camera calibration; {}", yaml_text.size(), kExpected));
  } else if (std::all_of(yaml_text.begin(), yaml_text.end(), [](unsigned char c) { return std::isspace(c); })) {
    in.fail(fmt::format("is empty: {}", kExpected));
  } else if (std::any_of(yaml_text.begin(), yaml_text.end(),
                         [](unsigned char c) { return c < 0x20 && !std::isspace(c); })) {
    in.fail(fmt::format("is not a text file: {}", kExpected));
  } else {
    try {
      const YAML::Node root = YAML::Load(without_directive(yaml_text));
      if (root.IsMap())
        result.format = read_any(in, root, &result.camera);
      else
        in.fail(fmt::format("is not a list of 'key: value': {}", kExpected));
    } catch (const YAML::Exception& e) {
      in.fail(fmt::format("is not correct YAML ({}): {}", e.what(), kExpected));
    }
  }
  const std::string check = in.error().empty() ? result.camera.check() : std::string();
  if (!check.empty()) in.fail(check + "; correct it there");
  if (!(result.camera.fps >= 0 && result.camera.fps <= 1e5))
    in.fail(fmt::format("fps is {:.6g}: must be 0 (unknown) to 100000 images per second", result.camera.fps));
  result.error = in.error();
  if (!result.ok()) result.camera = Camera();
  return result;
}

CameraFileResult read_camera_file(const std::string& file) {
  CameraFileResult result;
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status)) {
    result.error = fmt::format("{}: no such file; give the camera's calibration with --camera FILE", file);
  } else if (std::filesystem::is_directory(status)) {
    result.error = fmt::format("{}: is a folder; give the calibration file in it", file);
  } else {
    std::ifstream stream(file, std::ios::binary);
    std::string text(kMaxBytes + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
    if (!stream.is_open() || stream.bad())
      result.error = fmt::format("{}: cannot be read; check its permissions", file);
    else
      return parse_camera(text, file);
  }
  return result;
}

std::string camera_to_yaml(const Camera& camera) {
  const bool fisheye = camera.model == Camera::Model::kKannalaBrandt;
  std::string out = fmt::format("model: {}\n", fisheye ? "kannala_brandt" : "pinhole");
  const auto add = [&out](const char* key, double value) { out += fmt::format("{}: {:.17g}\n", key, value); };
  add("fx", camera.fx);
  add("fy", camera.fy);
  add("cx", camera.cx);
  add("cy", camera.cy);
  add("k1", camera.k1);
  add("k2", camera.k2);
  if (!fisheye) add("p1", camera.p1);
  if (!fisheye) add("p2", camera.p2);
  add("k3", camera.k3);
  if (fisheye) add("k4", camera.k4);
  out += fmt::format("width: {}\nheight: {}\n", camera.width, camera.height);
  add("fps", camera.fps);
  return out;
}

}  // namespace rumi
