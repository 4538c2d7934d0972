// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/page.h"

#include "report/markup.h"

#include <fmt/format.h>

namespace mneme::internal {
namespace {

constexpr std::string_view kStyle = R"css(
:root { color-scheme: light dark; --page: #f4f6fa; --card: #ffffff; --ink: #1f2937; --soft: #5b6675;
  --line: #dde3ec; --bad: #b42318; --c0: #c76a00; --c1: #5a7bb0; --c2: #0b8a6a; --c3: #8250df;
  --c4: #bf2c86; --c5: #5f8416; }
@media (prefers-color-scheme: dark) { :root { --page: #12161d; --card: #1b212b; --ink: #e6eaf0;
  --soft: #9aa6b6; --line: #323b49; --bad: #ff8a80; --c0: #f0a04b; --c1: #8fb0e6; --c2: #4cc3a1;
  --c3: #b79bff; --c4: #f07fc0; --c5: #a9cf5a; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 16px/1.5 Inter, "Helvetica Neue", Helvetica, Arial, "DejaVu Sans", sans-serif; }
main { max-width: 1320px; margin: 0 auto; padding: 32px 20px 56px; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 12px; }
h2 { font-size: 20px; margin: 40px 0 12px; }
p { max-width: 72ch; margin: 0 0 12px; }
.introduction { white-space: pre-line; }
.note, figcaption { color: var(--soft); font-size: 14px; }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 10px; padding: 18px;
  overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 14px;
  font-variant-numeric: tabular-nums; }
th, td { padding: 6px 12px; text-align: left; border-bottom: 1px solid var(--line);
  white-space: nowrap; }
th { color: var(--soft); font-weight: 600; }
tbody tr:last-child td { border-bottom: 0; }
.number { text-align: right; }
.bad { color: var(--bad); font-weight: 600; }
.pictures { display: grid; gap: 20px;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 520px), 1fr)); }
figure { margin: 0; }
figure > svg { display: block; width: 100%; height: auto; }
figcaption { padding-top: 10px; }
.wide { white-space: normal; overflow-wrap: anywhere; }
)css";

}  // namespace

std::string page_begin(const std::string& title, std::string_view rules) {
  const std::string heading = escape_markup(title);
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title>\n<style>{}{}</style>\n</head>\n<body>\n<main>\n<h1>{}</h1>\n",
      heading, kStyle, rules, heading);
}

std::string page_end() { return "</main>\n</body>\n</html>\n"; }

}  // namespace mneme::internal
