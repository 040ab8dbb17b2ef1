// SPDX-License-Identifier: BSD-3-Clause
// Measures the CPU time that map_server spends on one more submap, and on adjusting the whole map, for maps of
// different sizes. The submaps come from two rounds of a long ring corridor: front and back submaps in turns, each of
// which overlaps the next by ten keyframes; the second round sees again what the first one saw. Each submap is linked,
// welded and stored as map_server does it; the figures of the last one are printed. Each size is measured in a process
// of its own and makes one row.
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>

#include "base/or_throw.h"
#include "base/this_process/cpu_clock.h"
#include "bus/transport/bus.h"
#include "bus/wire/submap_update.h"
#include "map_server/map_status_pages.h"
#include "map_server/options.h"
#include "map_server/store/map_store.h"
#include "tests/map_server/synthetic_submaps.h"
#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

using testing::CameraPath;
using testing::Image;
using testing::TemporaryFolder;
using testing::World;

constexpr int kImagesPerKeyframe = 3, kOverlap = 10 * kImagesPerKeyframe;
constexpr double kStepM = 0.4 / kImagesPerKeyframe, kPointsPerM = 55, kReachM = 6;

// A corridor that is bent to a ring. Its points are sorted by their position along it.
struct Corridor {
  double length_m = 0;
  World world;

  double radius() const { return length_m / (2 * std::numbers::pi); }
  Eigen::Vector3d at(double along_m, double outwards_m, double height_m) const {
    const double angle = along_m / radius(), r = radius() + outwards_m;
    return {r * std::sin(angle), height_m, r * std::cos(angle)};
  }
};

Corridor make_corridor(double length_m) {
  Corridor corridor{length_m, {}};
  std::mt19937_64 rng(1);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng); };
  const int points = static_cast<int>(length_m * kPointsPerM);
  for (int i = 0; i < points; ++i) {
    const double outwards_m = uniform(2, 4), height_m = uniform(-1.2, 1.2);
    corridor.world.points.push_back(corridor.at(i / kPointsPerM, outwards_m, height_m));
    corridor.world.descriptors.push_back({rng(), rng(), rng(), rng()});
    corridor.world.octave0_distances.push_back(uniform(4, 8));
  }
  return corridor;
}

// Returns the points of the corridor between from_m and to_m, and their indices in corridor.world.
std::pair<World, std::vector<int>> stretch(const Corridor& corridor, double from_m, double to_m) {
  const int all = static_cast<int>(corridor.world.points.size());
  std::pair<World, std::vector<int>> part;
  const int first = static_cast<int>(from_m * kPointsPerM), last = static_cast<int>(to_m * kPointsPerM);
  for (int i = first; i < std::min(last, first + all); ++i) {
    const int p = (i % all + all) % all;
    part.second.push_back(p);
    part.first.points.push_back(corridor.world.points[p]);
    part.first.descriptors.push_back(corridor.world.descriptors[p]);
    part.first.octave0_distances.push_back(corridor.world.octave0_distances[p]);
  }
  return part;
}

std::vector<Image> film_two_rounds(const Corridor& corridor, int images) {
  constexpr int kAtOnce = 30;
  std::vector<Image> filmed;
  for (int begin = 0; begin < images; begin += kAtOnce) {
    testing::CameraPath path;
    for (int i = begin; i < std::min(images, begin + kAtOnce); ++i) {
      const double along_m = i * kStepM, angle = along_m / corridor.radius();
      const Eigen::Vector3d center = corridor.at(along_m, 2 * i < images ? 0 : 0.3, 0.2 * std::sin(along_m));
      path.push_back(SE3(so3_exp({0, angle + 0.4 * std::sin(0.3 * along_m), 0}), center).inverse());
    }
    const auto [world, ids] = stretch(corridor, begin * kStepM - kReachM, (begin + kAtOnce) * kStepM + kReachM);
    std::vector<Image> some = testing::film(world, path,
                                            {.seed = static_cast<unsigned>(begin),
                                             .most_keypoints = 1000,
                                             .every = kImagesPerKeyframe,
                                             .first_utime_us = 1'000'000 + begin * int64_t{33'333},
                                             .period_us = 33'333});
    for (Image& image : some) {
      for (int& point : image.point_of) point = ids[point];
      filmed.push_back(std::move(image));
    }
  }
  return filmed;
}

std::vector<Submap> make_submaps(int keyframes) {
  const int images = keyframes * kImagesPerKeyframe;
  const Corridor corridor = make_corridor(images * kStepM / 2);
  const std::vector<Image> filmed = film_two_rounds(corridor, images);
  const int length = std::min(100, keyframes / 4) * kImagesPerKeyframe;
  std::vector<Submap> submaps;
  for (int first = 0; first + kOverlap < images; first += length - kOverlap) {
    const int number = static_cast<int>(submaps.size());
    const bool back = number % 2 == 1;
    testing::SubmapRecipe recipe{.key = {1, back ? -number : number + 1},
                                 .kind = back ? SubmapKind::kBack : SubmapKind::kFront,
                                 .first = first,
                                 .last = std::min(images, first + length) - 1};
    recipe.submap_from_world = testing::random_gauge(static_cast<unsigned>(number));
    recipe.seed = static_cast<unsigned>(number);
    recipe.wrong_landmarks = 0.03;
    recipe.wrong_observations = 0.02;
    submaps.push_back(testing::make_submap(corridor.world, filmed, recipe).submap);
    submaps.back().closed = true;
  }
  return submaps;
}

double memory_mb(const char* field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(field)) return std::stod(line.substr(line.find(':') + 1)) / 1024;
  return std::numeric_limits<double>::quiet_NaN();
}

void forget_peak_memory() { std::ofstream("/proc/self/clear_refs") << 5; }

class Server {
 public:
  explicit Server(const std::string& file)
      : store_(map_server::MapStore::open(file).value()), finder_({}), builder_({}) {}

  void arrive(const Submap& made) {
    times_.clear();
    time("update", [&] {
      submap_update_t update;
      Bus::decode(encode_message(make_submap_update(made, 0)), &update);
      or_throw(atlas_.change_submap(made.key, [&](Submap* submap) { return apply_submap_update(update, submap); }));
    });
    time("store it", [&] { save(); });
    time("copy", [&] { copy(); });
    input_.scope = map_server::BuildScope::kWeld;
    time("search", [&] { search(graph_); });
    time("search, no news", [&] { search(next_graph_); });
    time("weld", [&] { build(); });
    welded_views_ = built_.report.adjusted_views;
    absorb("");
  }

  void adjust() {
    copy();
    input_.scope = map_server::BuildScope::kAll;
    time("adjust all", [&] {
      search(graph_);
      build();
    });
    absorb(" all");
  }

  void print(int keyframes) {
    fmt::print("| {} | {} | {} | {} |", keyframes, atlas_.submaps().size(), built_.report.members, welded_views_);
    for (const auto& [name, seconds] : times_) fmt::print(" {:.3g} |", 1e3 * seconds);
    fmt::print(" {:.0f} | {:.0f} | {:.0f} |\n", static_cast<double>(store_.bytes()) * 1e-6, memory_mb("VmRSS"),
               memory_mb("VmHWM"));
  }
  void print_header() const {
    std::string names = "| keyframes | submaps | in one map | welded views |", rule = "|---|---|---|---|";
    for (const auto& [name, seconds] : times_) names += " " + name + " |", rule += "---|";
    fmt::print("{} file MB | memory MB | peak MB |\n{}---|---|---|\n", names, rule);
  }

 private:
  template <class Work>
  void time(const std::string& what, const Work& work) {
    const double start_s = thread_cpu_s();
    work();
    times_.emplace_back(what, thread_cpu_s() - start_s);
  }

  // Saves in slices, as MapServerNode does tick by tick. Returns the CPU seconds of the longest slice.
  double save() {
    double longest_s = 0;
    do {
      const double start_s = thread_cpu_s();
      or_throw(store_.save(atlas_, {}, map_server::kSaveBudget));
      longest_s = std::max(longest_s, thread_cpu_s() - start_s);
    } while (store_.is_behind());
    return longest_s;
  }

  // As in MapMerger, graph_ stays as it is until a build is taken over.
  void search(const map_server::LinkGraph& before) { next_graph_ = finder_.find(before, input_); }
  void build() {
    built_ = builder_.build(std::move(next_graph_), input_);
    graph_ = std::move(built_.graph);
  }

  // Copies the submaps that have changed, as MapMerger does.
  void copy() {
    for (const auto& [key, owner] : atlas_.submaps()) {
      std::shared_ptr<const Submap>& copy = copies_[key];
      if (!copy || copy->revision != owner.submap.revision) copy = std::make_shared<const Submap>(owner.submap);
      input_.submaps[key] = copy.get();
    }
  }

  // Returns the submaps whose placements did not change, and keeps all placements for the next build. MapMerger does
  // this in its thread.
  std::set<SubmapKey> find_same() {
    std::set<SubmapKey> same;
    for (const auto& [key, placement] : built_.placements) {
      const auto before = input_.placed.find(key);
      if (before != input_.placed.end() && same_place(before->second, placement)) same.insert(key);
      input_.placed[key] = placement;
    }
    return same;
  }

  // Takes over a build and saves, as MapServerNode does. `which` is appended to the names of the measured times.
  void absorb(const std::string& which) {
    const std::set<SubmapKey> same = find_same();
    std::vector<map_server::Placement> before;
    for (const auto& [key, left] : built_.culled)  // map_server spreads this over several ticks
      or_throw(atlas_.change_submap(key, [&left = left](Submap* submap) {
        *submap = *left;
        return Result<>();
      }));
    map_server::PlacedMap map;
    if (!built_.placements.empty())
      map = map_server::PlacedMap::make(std::move(built_.placements), std::move(built_.unmoved)).value();
    map.note_same(same);
    time("place" + which, [&] {
      or_throw(atlas_.set_links(graph_.links()));
      if (!built_.placements.empty()) before = atlas_.place_map(std::move(map)).value();
    });
    for (auto& [key, placement] : input_.placed) placement.revision = atlas_.find(key)->placement.revision;
    time("tell", [&] { status_pages_.next(atlas_, 0); });
    double longest_s = 0;
    time("store" + which, [&] { longest_s = save(); });
    times_.emplace_back("its longest part", longest_s);
  }

  map_server::Atlas atlas_;
  map_server::MapStore store_;
  map_server::LinkFinder finder_;
  map_server::MapBuilder builder_;
  map_server::LinkGraph graph_, next_graph_;
  map_server::MapStatusPages status_pages_;
  std::map<SubmapKey, std::shared_ptr<const Submap>> copies_;
  map_server::BuildInput input_;
  map_server::BuiltMap built_;
  int welded_views_ = 0;
  std::vector<std::pair<std::string, double>> times_;
};

int measure(int keyframes, bool adjust, bool header) {
  const TemporaryFolder folder;
  Server server(folder / "map.db");
  std::vector<Submap> submaps = make_submaps(keyframes);
  forget_peak_memory();
  for (Submap& submap : submaps) {
    server.arrive(submap);
    submap = {};  // frees the memory: in a live system, another process holds it
  }
  if (adjust) server.adjust();
  if (header) server.print_header();
  server.print(keyframes);
  std::fflush(stdout);
  return 0;
}

int run(int argc, char** argv) {
  std::vector<int> sizes = {100, 1000};
  bool no_adjustment = false;
  CLI::App app("Time and memory of map_server against the size of its map. Milliseconds of CPU.");
  app.add_option("KEYFRAMES", sizes, "sizes of the map")->check(CLI::Range(60, 1'000'000))->capture_default_str();
  app.add_flag("--no-adjustment", no_adjustment, "without that of the whole map");
  CLI11_PARSE(app, argc, argv);
  for (size_t i = 0; i < sizes.size(); ++i) {
    const pid_t child = fork();
    if (child == 0) return measure(sizes[i], !no_adjustment, i == 0);
    int status = 0;
    waitpid(child, &status, 0);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return 1;
  }
  return 0;
}

}  // namespace
}  // namespace rumi

int main(int argc, char** argv) { return rumi::run(argc, argv); }
