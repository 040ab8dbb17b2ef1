// SPDX-License-Identifier: BSD-3-Clause
// write_seeds FOLDER: writes the seeds of every target to files FOLDER/TARGET/seed-N, from which libFuzzer starts.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "fuzz/target.h"

namespace fs = std::filesystem;

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write_seeds FOLDER\n";
    return 2;
  }
  for (const rumi::fuzz::Target& target : rumi::fuzz::targets()) {
    const fs::path folder = fs::path(argv[1]) / target.name;
    fs::create_directories(folder);
    int number = 0;
    for (const rumi::fuzz::Bytes& seed : target.seeds()) {
      std::ofstream out(folder / ("seed-" + std::to_string(number++)), std::ios::binary);
      out.write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
      if (!out) {
        std::cerr << folder << ": cannot be written\n";
        return 1;
      }
    }
  }
  return 0;
}
