// SPDX-License-Identifier: BSD-3-Clause
// What is said to COLMAP's mapper, and what it says, in the words of the COLMAP that is installed: from 3.8 to 4.x
// names of options change, come and go. A version is told by the options that its help names, not by its number.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "ruminator/colmap/mapper_command.h"

namespace rumi::ruminator {

using OptionNames = std::set<std::string>;  // without dashes

// What the mapper is started with, from its name on. An option of which it knows no name is left out: it would refuse
// to start.
std::vector<std::string> mapper_arguments(const MapperCommand& command, const MapperSettings& settings,
                                          const OptionNames& known);

// Which options are missing without which its models would be of no use: "--this", "--that or --its later name".
std::vector<std::string> missing_options(const OptionNames& known);
// And which others, without which it goes its own way: slower, or to other models.
std::vector<std::string> options_left_out(const OptionNames& known);

// How many images the growing model has, if the line tells it.
std::optional<int> registered_images(std::string_view line);
// The mapper found no model in the images: the images' fault, not the program's.
bool tells_of_no_model(std::string_view output);

}  // namespace rumi::ruminator
