// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/report/run_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>

#include "base/files/file_access.h"
#include "base/or_throw.h"
#include "base/text/json_text.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "map_server/alignment/submap_alignment.h"
#include "rumi/evaluation/run_evaluation.h"
#include "rumi/outputs/map_file.h"
#include "rumi/outputs/masks.h"
#include "rumi/outputs/output_folder.h"
#include "rumi/report/evaluation_plot.h"
#include "rumi/report/html_page.h"
#include "rumi/report/mask_picture.h"
#include "rumi/report/match_history.h"
#include "rumi/run/load_over_time.h"
#include "rumi/run/process_load.h"
#include "ruminator/window/window_job.h"
#include "viewer_offscreen/picture/draw_map.h"
#include "viewer_offscreen/picture/renderer.h"
#include "viewer_offscreen/picture/timeline_strip.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr size_t kThumbnailsPerWindow = 16;
constexpr int kThumbnailWidth = 240;

std::string name_of(SubmapKey key) { return fmt::format("{} {}", key.id < 0 ? "back" : "front", std::abs(key.id)); }

std::string text_of(const ordered_json& value) {
  if (value.is_null()) return "unknown";
  if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
  return value.is_string() ? value.get<std::string>() : json_text(value);
}

double seconds_since(int64_t first_us, int64_t utime_us) { return 1e-6 * static_cast<double>(utime_us - first_us); }

void add_missing(const ordered_json& run, HtmlPage* page) {
  if (!run.contains("missing") || !run["missing"].is_array()) return;
  for (const ordered_json& problem : run["missing"]) page->paragraph("Missing: " + text_of(problem));
}

void add_summary(const ordered_json& run, const AtlasCounts& counts, HtmlPage* page) {
  std::vector<std::vector<std::string>> rows;
  for (const char* key : {"input", "lcm_url", "command", "version", "wall_s", "cpu_s", "peak_rss_mb"})
    if (run.contains(key)) rows.push_back({key, text_of(run[key])});
  rows.push_back({"frames", fmt::format("{}", counts.frames)});
  rows.push_back({"frames with a pose in the map", fmt::format("{}", counts.frames_in_map)});
  rows.push_back({"frames with a pose in any submap", fmt::format("{}", counts.tracked_frames)});
  rows.push_back(
      {"submaps, keyframes, landmarks", fmt::format("{}, {}, {}", counts.submaps, counts.keyframes, counts.landmarks)});
  page->section("Run");
  page->table({}, rows);
  add_missing(run, page);
}

void add_views(const cv::Mat& all, const viewer_offscreen::Scene& scene, viewer_offscreen::Renderer* renderer,
               HtmlPage* page) {
  page->section(
      "Map",
      "Front submaps are full lines in cool colours; back submaps, rebuilt from what could not be tracked, warm "
      "lines with a white core.");
  page->picture(viewer_offscreen::encode_png(all), "png", "All views");
  page->picture(viewer_offscreen::encode_png(renderer->draw(scene, viewer_offscreen::ViewKind::kTop)), "png",
                "From above");
  page->picture(viewer_offscreen::encode_png(renderer->draw(scene, viewer_offscreen::ViewKind::kSide)), "png",
                "From the side");
}

void add_timeline(const cv::Mat& all, const viewer_offscreen::Scene& scene, HtmlPage* page) {
  page->section("Tracking over time");
  const cv::Rect strip = viewer_offscreen::layout_all(false).strip;
  page->picture(viewer_offscreen::encode_png(all(strip)), "png",
                "How each frame was tracked, and where it is in the map");
  if (scene.lost.empty()) return page->paragraph("Every frame has a pose in some submap.");
  std::vector<std::vector<std::string>> rows;
  for (const viewer_offscreen::LostSpan& span : scene.lost)
    rows.push_back({viewer_offscreen::format_time(seconds_since(scene.first_us, span.first_us)),
                    viewer_offscreen::format_time(seconds_since(scene.first_us, span.last_us)),
                    fmt::format("{}", span.frames)});
  page->paragraph("Without a pose in any submap:");
  page->table({"from", "to", "frames"}, rows);
}

void add_errors(const std::string& folder, const std::string& groundtruth, const TruthOptions& truth, HtmlPage* page) {
  const RunEvaluation evaluation = or_throw(evaluate_folder(folder, groundtruth, {truth, {}}));
  page->section("Error", "Against " + groundtruth + ", after Sim(3) alignment.");
  page->picture(viewer_offscreen::encode_png(draw_evaluation(evaluation.run, evaluation.truth)), "png",
                "Path and error over time");
  for (const std::string& note : evaluation.notes) page->paragraph(note);
  const ordered_json json = to_json(evaluation);
  std::vector<std::vector<std::string>> rows;
  for (const auto& [key, value] : json.items())
    if (!value.is_structured() && !(value.is_string() && value.get<std::string>().empty()))
      rows.push_back({key, text_of(value)});
  page->table({}, rows);
  rows.clear();
  for (const auto& submap : json["per_submap"])
    rows.push_back({text_of(submap["name"]), text_of(submap["frames"]), text_of(submap["ate_rmse_m"]),
                    text_of(submap["ate_in_map_rmse_m"]), text_of(submap["path_m"])});
  page->table({"submap", "frames", "ATE, m", "ATE in the map, m", "path, m"}, rows);
}

std::vector<uint8_t> thumbnail(const image_t& image) {
  const cv::Mat bgr = decode_bgr(image).value_or(cv::Mat());
  if (bgr.empty()) return {};
  cv::Mat small;
  cv::resize(bgr, small, {kThumbnailWidth, std::max(1, kThumbnailWidth * bgr.rows / bgr.cols)}, 0, 0, cv::INTER_AREA);
  std::vector<uint8_t> jpeg;
  cv::imencode(".jpg", small, jpeg, {cv::IMWRITE_JPEG_QUALITY, 80});
  return jpeg;
}

// Returns evenly chosen images of the window, with frames in the colours of the sampling picture.
std::vector<HtmlPage::Thumbnail> window_images(const ruminator::WindowJob& job, int64_t first_us) {
  std::vector<HtmlPage::Thumbnail> thumbnails;
  const size_t n = std::min(kThumbnailsPerWindow, job.images.size());
  for (size_t k = 0; k < n; ++k) {
    const image_t& image = job.images[n == 1 ? 0 : k * (job.images.size() - 1) / (n - 1)];
    const auto is_in = [&](const std::vector<ruminator::Sample>& part) {
      return std::any_of(part.begin(), part.end(),
                         [&](const ruminator::Sample& s) { return s.utime_us == image.utime; });
    };
    const bool approach = is_in(job.window.approach), gap = is_in(job.window.gap);
    const char* part = approach ? "approach" : gap ? "gap" : "departure";
    thumbnails.push_back(
        {thumbnail(image),
         fmt::format("{}, {}", part, viewer_offscreen::format_time(seconds_since(first_us, image.utime))),
         approach ? "#009e73"
         : gap    ? "#cc79a7"
                  : "#3c3c3c"});
  }
  std::erase_if(thumbnails, [](const auto& t) { return t.jpeg.empty(); });
  return thumbnails;
}

std::vector<fs::path> window_files(const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(fs::path(folder) / "windows", none))
    if (entry.path().extension() == ".window") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

void add_windows(const std::string& folder, const map_server::Atlas& atlas, int64_t first_us, HtmlPage* page) {
  page->section("Windows", "What was sampled around each loss of tracking, to be rebuilt.");
  const std::vector<fs::path> files = window_files(folder);
  if (files.empty()) return page->paragraph("The folder holds no windows.");
  for (const fs::path& file : files) {
    const Result<ruminator::WindowJobFile> read = ruminator::read_window_job(file.string());
    if (!read) {
      page->paragraph(read.error_text());
      continue;
    }
    const ruminator::RuminationWindow& w = read->job.window;
    const map_server::AtlasSubmap* rebuilt = atlas.find({w.session, -w.id});
    const std::string outcome = !rebuilt ? "no back submap of it has come"
                                         : fmt::format("back submap: {} frames, {}", rebuilt->submap.frames.size(),
                                                       rebuilt->in_map ? "in the map" : "not joined to the map");
    const auto submap = [](int32_t id) {
      return id == kNoSubmap ? std::string("nothing") : fmt::format("front {}", id);
    };
    page->paragraph(fmt::format(
        "Window {}: lost at {} after {}, then {}; {} approach, {} of {} gap, {} departure frames; {}", w.id,
        viewer_offscreen::format_time(seconds_since(first_us, w.lost_utime_us)), submap(w.submap_before),
        submap(w.submap_after), w.approach.size(), w.gap.size(), w.gap_frames, w.departure.size(), outcome));
    page->thumbnails(window_images(read->job, first_us));
  }
}

// Returns an image of the stream, over which its mask is drawn; an empty one if no window has such an image.
image_t image_of_stream(const std::string& folder, int64_t stream) {
  for (const fs::path& file : window_files(folder)) {
    const Result<ruminator::WindowJobFile> read = ruminator::read_window_job(file.string());
    if (!read) continue;
    for (const image_t& image : read->job.images)
      if (stream_of(image) == stream || (stream_of(image) == kNoStream && read->job.window.session == stream))
        return image;
  }
  return {};
}

void add_masks(const std::string& folder, const map_server::Atlas& atlas, HtmlPage* page) {
  const RunMasks masks = masks_of(atlas);
  if (masks.empty()) return;
  page->section("Masks", "What never moves in the images is not the world: no landmark is made of it.");
  for (const std::string& line : describe_masks(masks)) page->paragraph(line);
  for (const auto& [stream, mask] : masks) {
    const Result<cv::Mat> image = decode_bgr(image_of_stream(folder, stream));
    const cv::Mat picture = draw_mask(mask.png, image.value_or(cv::Mat()));
    if (!picture.empty())
      page->picture(viewer_offscreen::encode_png(picture), "png", fmt::format("Left out of stream {}", stream));
  }
}

void add_joins(const map_server::Atlas& atlas, HtmlPage* page) {
  page->section("Joins", "Attempts to align two submaps; those that were accepted hold the map together.");
  if (atlas.links().empty()) return page->paragraph("No two submaps were compared.");
  std::vector<std::vector<std::string>> rows;
  for (const map_server::Link& link : atlas.links())
    rows.push_back({name_of(link.a), name_of(link.b),
                    link.kind == map_server::Link::Kind::kSameImages ? "same images"
                    : link.a == link.b                               ? "loop"
                                                                     : "same place",
                    link.accepted() ? "joined" : "refused: " + link.doubt,
                    fmt::format("{} of {}", link.keyframe_inliers, link.keyframes),
                    fmt::format("{} of {}", link.landmark_inliers, link.landmarks),
                    fmt::format("{:.2f}", link.rmse_px)});
  page->table({"submap", "submap", "by", "", "keyframes agree", "landmarks agree", "RMSE, px"}, rows);
}

void add_matches(const ordered_json& run, const map_server::Atlas& atlas, HtmlPage* page) {
  page->section(
      "Data association",
      "Features of an image that two submaps know: what joins submaps. Of back submaps from which post-culling "
      "has taken images, what is left.");
  const map_server::AlignmentOptions defaults;
  const double max_reprojection_px = run.value(
      nlohmann::ordered_json::json_pointer("/options/map_server/max_reprojection_px"), defaults.max_reprojection_px);
  const MatchHistory history = match_history(atlas, max_reprojection_px);
  if (history.empty()) return page->paragraph("No two submaps have an image in common.");
  page->picture(viewer_offscreen::encode_png(draw_matches(history)), "png", "Matched features over time");
  const auto row = [](const char* name, const std::map<int64_t, ImageMatches>& images) {
    int64_t matched = 0, verified = 0;
    for (const auto& [utime_us, matches] : images) {
      matched += matches.matched;
      verified += matches.verified;
    }
    return std::vector<std::string>{name, fmt::format("{}", images.size()), fmt::format("{}", matched),
                                    fmt::format("{}", verified)};
  };
  page->table({"", "images", "features matched", "of these, geometry agrees"},
              {row("with back submaps", history.back), row("between front submaps alone", history.front)});
}

void add_load(const ordered_json& run, HtmlPage* page) {
  page->section("Load");
  std::vector<std::vector<std::string>> rows;
  if (run.contains("processes") && run["processes"].is_object()) {
    for (const auto& [name, status] : run["processes"].items())
      rows.push_back({name, text_of(status.value("running_s", ordered_json())),
                      text_of(status.value("cpu_s", ordered_json())), text_of(status.value("rss_mb", ordered_json())),
                      text_of(status.value("detail", ordered_json()))});
    return page->table({"process", "running, s", "CPU, s", "memory, MB", "it says"}, rows);
  }
  if (!run.contains("cpu_ms_per_frame") || !run["cpu_ms_per_frame"].is_object())
    return page->paragraph("run.json does not tell.");
  for (const auto& [name, ms] : run["cpu_ms_per_frame"].items()) rows.push_back({name, text_of(ms)});
  page->table({"component", "CPU per frame, ms"}, rows);
}

// From the log of a live run, or what a replay noted.
void add_load_over_time(const ordered_json& run, const std::string& log, HtmlPage* page) {
  const ProcessLoad load =
      log.empty() ? load_from_json(run.value("load", ordered_json())) : or_throw(read_process_load(log));
  if (load.memory_mb.empty()) return;
  page->chart("CPU", "% of a core", load.cpu_percent);
  page->chart("Memory", "MB", load.memory_mb);
}

// How well each frame of the map is known where its submap sees it from.
void add_deviations(const map_server::Atlas& atlas, int64_t first_us, HtmlPage* page) {
  HtmlPage::Lines lines;
  for (const auto& [image, record] : atlas.frames()) {
    const std::optional<map_server::LocatedFrame> located = atlas.locate(image);
    if (!located || !located->owner->in_map) continue;
    const PoseSigmas sigmas = located->sigmas();
    if (sigmas.are_known()) lines["position"].emplace_back(seconds_since(first_us, image.utime_us), sigmas.position);
  }
  if (!lines.empty()) page->chart("Standard deviation", "map units", lines);
}

AtlasCounts counts_of(const ordered_json& run) {
  const ordered_json counts = run.value("counts", ordered_json::object());
  const auto number = [&](const char* name) { return counts.value(name, 0); };
  AtlasCounts result;
  result.frames = number("frames");
  result.frames_in_map = number("frames_in_map");
  result.tracked_frames = number("tracked_frames");
  result.submaps = number("submaps");
  result.keyframes = number("keyframes");
  result.landmarks = number("landmarks");
  return result;
}

// Returns the path of trajectory.txt as a submap without landmarks, so that it can be drawn.
Submap path_alone(const std::string& folder) {
  const TrajectoryFile path = read_trajectory((fs::path(folder) / "trajectory.txt").string());
  if (!path.ok()) throw std::runtime_error(path.error);
  Submap submap;
  submap.key = {1, 1};
  Keyframe first;
  first.id = 0;
  submap.keyframes[0] = first;
  for (const TimedPose& pose : path.poses) submap.frames.set({pose.utime_us, 0, pose.map_from_cam.inverse()});
  return submap;
}

bool lacks_its_map(const std::string& folder, const ordered_json& run) {
  return run.contains("missing") && !fs::exists(fs::path(folder) / "map.db");
}

// Makes a shorter page from the other files, for a run whose map did not fit on the disk.
std::string report_without_map(const std::string& folder, const ordered_json& run, const ReportOptions& options) {
  const Submap path = path_alone(folder);
  viewer_offscreen::MapPicture picture;
  picture.submaps.push_back({&path, true});
  const viewer_offscreen::Scene scene = viewer_offscreen::make_scene(picture);
  viewer_offscreen::Renderer renderer;
  HtmlPage page("Rumi: " + text_of(run.value("input", ordered_json(folder))));
  add_summary(run, counts_of(run), &page);
  add_views(renderer.draw(scene), scene, &renderer, &page);
  if (!options.groundtruth.empty()) add_errors(folder, options.groundtruth, options.truth, &page);
  add_load(run, &page);
  add_load_over_time(run, options.log, &page);
  return page.finish();
}

}  // namespace

std::string make_report(const std::string& folder, const ReportOptions& options) {
  if (const std::string why = why_unreadable(folder, "give the output folder of a run"); !why.empty())
    throw std::runtime_error(fmt::format("{}: {}", folder, why));
  const ordered_json run = read_run_json(folder);
  if (run.is_null())
    throw std::runtime_error(fmt::format("{}: is no output folder of a run (it has no run.json of ours)", folder));
  if (!run.value("finished", false))
    throw std::runtime_error(fmt::format("{}: the run was not finished (run.json)", folder));
  if (lacks_its_map(folder, run)) return report_without_map(folder, run, options);
  const map_server::Atlas atlas = load_map((fs::path(folder) / "map.db").string());
  AtlasPicture shown = make_picture(atlas, "Rumi");
  if (!options.groundtruth.empty()) {
    const TruthFile path = read_groundtruth(options.groundtruth, options.truth);
    if (!path.ok()) throw std::runtime_error(path.error);
    for (const TimedPose& pose : path.poses) shown.picture.groundtruth[pose.utime_us] = pose.map_from_cam.translation;
  }
  const viewer_offscreen::Scene scene = viewer_offscreen::make_scene(shown.picture);
  viewer_offscreen::Renderer renderer;
  HtmlPage page("Rumi: " + text_of(run.value("input", ordered_json(folder))));
  add_summary(run, count(atlas), &page);
  const cv::Mat all = renderer.draw(scene);
  add_views(all, scene, &renderer, &page);
  add_timeline(all, scene, &page);
  add_deviations(atlas, scene.first_us, &page);
  if (!options.groundtruth.empty()) add_errors(folder, options.groundtruth, options.truth, &page);
  add_windows(folder, atlas, scene.first_us, &page);
  add_masks(folder, atlas, &page);
  add_joins(atlas, &page);
  add_matches(run, atlas, &page);
  add_load(run, &page);
  add_load_over_time(run, options.log, &page);
  return page.finish();
}

}  // namespace rumi::tool
