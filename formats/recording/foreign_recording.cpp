// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/foreign_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "formats/recording/file_kind.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

// Recognizes archives, and files that only stand for others. Returns what to do, or an empty string.
std::string advice_on_container(const fs::path& file, const std::string& beginning) {
  using namespace std::string_literals;
  if (beginning.starts_with("version https://git-lfs"))
    return "is a pointer of Git LFS, not the recording: run `git lfs pull` where it was cloned";
  struct Packed {
    std::string beginning;
    const char* how;
  };
  const bool is_tar = fs::path(file).stem().extension() == ".tar" || lower_extension(file) == ".tgz";
  const std::array packed = {
      Packed{"\x1F\x8B"s, is_tar ? "tar xf" : "gunzip -k"},
      Packed{"PK\x03\x04"s, "unzip"},
      Packed{"BZh"s, is_tar ? "tar xf" : "bunzip2 -k"},
      Packed{"\xFD\x37zXZ"s, is_tar ? "tar xf" : "unxz -k"},
      Packed{"\x28\xB5\x2F\xFD"s, "unzstd"},
      Packed{"7z\xBC\xAF"s, "7z x"},
      Packed{"Rar!"s, "unrar x"},
  };
  for (const Packed& kind : packed)
    if (beginning.starts_with(kind.beginning))
      return fmt::format("is packed: unpack it (`{} {}`) and give what was in it", kind.how, file.string());
  if (lower_extension(file) == ".tar")
    return fmt::format("is packed: unpack it (`tar xf {}`) and give what was in it", file.string());
  return {};
}

// Recognizes recordings of other systems by their extensions, and archives by their beginnings. Returns what to do, or
// an empty string.
std::string advice_on_file(const fs::path& file) {
  using namespace std::string_literals;
  const std::string beginning = beginning_of(file, 32), extension = lower_extension(file);
  struct Other {
    const char *extension, *what, *how;
  };
  constexpr std::array kOthers = {
      Other{".svo", "a recording of a ZED camera", "ZED's SDK writes the left images or a video (svo_export)"},
      Other{".svo2", "a recording of a ZED camera", "ZED's SDK writes the left images or a video (svo_export)"},
      Other{".klg", "a Kinect log (Logger2)", "write its colour images into a folder, with their times as names"},
      Other{".oni", "a recording of OpenNI", "write its colour images into a folder, with their times as names"},
      Other{".vrs", "a VRS file", "`vrs extract-images` writes its images"},
  };
  for (const Other& other : kOthers)
    if (extension == other.extension)
      return fmt::format("is {}, which is not read: {}; give that folder or video, with --camera FILE", other.what,
                         other.how);
  return advice_on_container(file, beginning);
}

uint64_t big_endian(const std::string& bytes, size_t at, size_t count) {
  uint64_t value = 0;
  for (size_t i = at; i < at + count && i < bytes.size(); ++i)
    value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

// True if the file is an MP4 or MOV file without its index, the box `moov`.
bool lacks_index(const fs::path& file) {
  constexpr size_t kHeadBytes = 16, kLeastBytes = 8;
  constexpr int kMostBoxes = 100'000;
  std::ifstream in(file, std::ios::binary);
  uint64_t at = 0;
  std::string head(kHeadBytes, '\0');
  for (int box = 0; box < kMostBoxes; ++box) {
    in.seekg(static_cast<std::streamoff>(at));
    in.read(head.data(), static_cast<std::streamsize>(kHeadBytes));
    const auto got = static_cast<size_t>(std::max<std::streamsize>(0, in.gcount()));
    const std::string name = head.substr(4, 4);
    if (box == 0 && (got < kLeastBytes || name != "ftyp")) return false;
    if (got < kLeastBytes) return true;
    if (name == "moov") return false;
    const uint64_t size = big_endian(head, 0, 4);
    const uint64_t length = size == 1 ? big_endian(head, 8, 8) : size;
    constexpr uint64_t kMostBytes = uint64_t{1} << 60;
    if (length < kLeastBytes || length > kMostBytes) return true;  // length 0: the last box; others are impossible
    at += length;
    in.clear();
  }
  return true;
}

}  // namespace

std::string why_no_video(const fs::path& file) {
  if (!lacks_index(file)) return {};
  return "was never closed: its index (`moov`) is missing, because the recorder was stopped or the copy broken off; "
         "copy or record it again (`untrunc` can mend it with the help of a good video of the same camera)";
}

std::string advice_on_input(const std::string& input) {
  if (input == "-") return "is a pipe, which is not read: write what comes from it into a file, and give that";
  if (const size_t at = input.find("://"); at != std::string::npos && at > 1 && input.find('/') == at + 1)
    return input.starts_with("file://")
               ? "is an address: give the path behind file:// alone"
               : fmt::format(
                     "is an address, which is not read: record it, as with `ffmpeg -i {} -c copy FILE.mkv`, "
                     "and give that file",
                     input);
  const std::string name = fs::path(input).filename().string();
  const size_t percent = name.find('%');
  const size_t letter = percent == std::string::npos ? percent : name.find_first_not_of("0123456789", percent + 1);
  if ((letter != std::string::npos && name[letter] == 'd') || name.find_first_of("*?") != std::string::npos)
    return "is a pattern, which is not read: give the folder; its images are played in the order of their numbers, and "
           "--set camera_driver.files=PATTERN (with * and ?) chooses some of them";
  return {};
}

std::string advice_on_foreign_recording(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? "" : advice_on_file(path);
}

}  // namespace rumi
