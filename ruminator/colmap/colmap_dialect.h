// SPDX-License-Identifier: BSD-3-Clause
// Adapts to the installed COLMAP: from 3.8 to 4.x, options of its mapper were added, renamed and removed. Which options
// exist is read from its help text; the version number is not used.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "ruminator/colmap/mapper_command.h"

namespace rumi::ruminator {

using OptionNames = std::set<std::string>;  // names of options, without the leading dashes

// Returns the arguments of the mapper, beginning with its name. Leaves out options that this COLMAP does not know,
// because it would refuse to start with them.
std::vector<std::string> mapper_arguments(const MapperCommand& command, const MapperSettings& settings,
                                          const OptionNames& known);

// Returns the required options that are missing, as "--name" or "--name or --later name". Without them COLMAP cannot be
// used.
std::vector<std::string> missing_options(const OptionNames& known);
// Returns the other missing options; without them the mapper is slower or finds other models.
std::vector<std::string> options_left_out(const OptionNames& known);

// Returns how many images the growing model has if this line of the output tells it; otherwise nullopt.
std::optional<int> registered_images(std::string_view line);
// True if the mapper says that it found no model. Then the fault is in the images, not in the program.
bool tells_of_no_model(std::string_view output);

}  // namespace rumi::ruminator
