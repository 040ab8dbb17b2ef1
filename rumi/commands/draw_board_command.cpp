// SPDX-License-Identifier: BSD-3-Clause
// rumi draw-board -o board.pdf: draws a calibration board to print.
#include <fmt/format.h>

#include <memory>

#include "rumi/calibration/board_page.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"

namespace rumi::tool {
namespace {

struct Arguments {
  std::string file, board = Board().to_string(), paper = papers().front().name;
  double dpi = 300;
};

void draw(const Arguments& arguments) {
  const Board board = value_or_refuse(parse_board(arguments.board));
  for (const Paper& paper : papers())
    if (arguments.paper == paper.name) fail_if(write_board_page(board, paper, arguments.dpi, arguments.file));
  fmt::print("{}: board {} on {}; print it at 100 %, and measure a square: {} mm\n", arguments.file, board.to_string(),
             arguments.paper, board.square_mm);
}

}  // namespace

void add_draw_board_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command("draw-board", "Make a calibration board to print, for `rumi calibrate`");
  command->add_option("-o,--output", arguments->file, "the file; its ending tells what: .pdf or .png")
      ->type_name("FILE")
      .required();
  command->add_option("--board", arguments->board, "what board; columns and rows count squares")
      ->type_name(kBoardSyntax)
      ->show_default();
  std::vector<std::string> names;
  for (const Paper& paper : papers()) names.emplace_back(paper.name);
  command->add_option("--paper", arguments->paper, "it is turned as fits")->one_of(names)->show_default();
  command->add_option("--dpi", arguments->dpi, "of a .png, pixels per inch")->in_range(72.0, 1200.0)->show_default();
  std::string dictionaries;
  for (const BoardDictionary& dictionary : board_dictionaries())
    dictionaries += (dictionaries.empty() ? "" : ", ") + std::string(dictionary.name);
  command->footer(fmt::format("Boards: charuco:9x7:26:19:4X4_50, chessboard:9x7:26. DICTIONARY is {}.", dictionaries));
  run_if_chosen(command, chosen, arguments, draw);
}

}  // namespace rumi::tool
