// SPDX-License-Identifier: BSD-3-Clause
// Talks to the COLMAP that is installed: from 3.8 to 4.x, options of its mapper are added, renamed and removed. The
// help says which options there are; the version's number is not used.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "ruminator/colmap/mapper_command.h"

namespace rumi::ruminator {

using OptionNames = std::set<std::string>;  // without dashes

// Returns the arguments of the mapper, its name first. Leaves out options that it does not know, because it would
// refuse to start.
std::vector<std::string> mapper_arguments(const MapperCommand& command, const MapperSettings& settings,
                                          const OptionNames& known);

// Returns the missing options without which the models would be useless: "--this", "--that or --its later name".
std::vector<std::string> missing_options(const OptionNames& known);
// Returns the other missing options: without them the mapper is slower, or finds other models.
std::vector<std::string> options_left_out(const OptionNames& known);

// Returns how many images the growing model has, if this line of the output says so.
std::optional<int> registered_images(std::string_view line);
// True if the mapper says that it found no model: the images are to blame, not the program.
bool tells_of_no_model(std::string_view output);

}  // namespace rumi::ruminator
