#pragma once

namespace vismap {

/// The style sheet of a report: light or dark, as the browser is.
inline constexpr char kReportStyle[] = R"css(
:root { color-scheme: light dark; --paper: #fff; --ink: #1c1f24; --line: #d4d8de; --accent: #0b62a8; --row: #eef4fa; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #16181c; --ink: #e6e8eb; --line: #3a3f47; --accent: #7fbdf0; --row: #22303d; }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 15px/1.5 system-ui, sans-serif; }
header, main { max-width: 1240px; margin: 0 auto; padding: 12px 20px; }
h1 { margin: 8px 0; overflow-wrap: anywhere; }
h2 { border-bottom: 2px solid var(--line); padding-bottom: 4px; margin-top: 36px; }
nav a { margin-right: 10px; }
a { color: var(--accent); }
.table { overflow-x: auto; }
table { border-collapse: collapse; margin: 8px 0; }
th, td { text-align: left; vertical-align: middle; padding: 3px 12px 3px 4px; border-bottom: 1px solid var(--line); overflow-wrap: anywhere; }
tr[aria-selected="true"] { background: var(--row); outline: 2px solid var(--accent); }
tr[data-object].live { cursor: pointer; }
figure { margin: 12px 0; }
img { max-width: 100%; height: auto; border-radius: 4px; }
td img { display: block; }
figcaption { font-size: 13px; opacity: 0.8; }
canvas { display: block; width: 100%; height: min(70vh, 640px); border: 1px solid var(--line); border-radius: 4px; touch-action: none; }
pre { overflow: auto; max-height: 480px; border: 1px solid var(--line); padding: 8px; }
.bar { display: inline-block; height: 10px; min-width: 1px; max-width: 200px; background: var(--accent); }
td:has(> .bar) { width: 220px; }
.findings li { margin: 4px 0; }
)css";

}  // namespace vismap
