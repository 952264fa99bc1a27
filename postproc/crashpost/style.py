"""The look of the report: one column of prose, figures in a grid, everything printable."""

CSS = """
:root { --ink: #1c2126; --muted: #66707a; --rule: #e4e7ea; --soft: #f6f7f8; --accent: #1f5a99;
  --good: #2a7d55; --bad: #b3341f; --wait: #a06c00;
  --sans: system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "Noto Sans", sans-serif;
  --serif: Charter, "Iowan Old Style", "Palatino Linotype", "Source Serif 4", Georgia, serif;
  --mono: ui-monospace, "SF Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace; }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0 auto; max-width: 72rem; padding: 3rem 1.5rem 5rem; background: #fff;
  color: var(--ink); font: 1rem/1.55 var(--sans); font-variant-numeric: tabular-nums; }
h1, h2 { font-family: var(--serif); font-weight: 600; line-height: 1.2; text-wrap: balance; }
h1 { font-size: clamp(1.7rem, 4.5vw, 2.5rem); margin: .2rem 0 .8rem; letter-spacing: -.01em; }
h2 { font-size: 1.4rem; margin: 3.5rem 0 1.1rem; }
h3 { font-size: 1rem; font-weight: 600; margin: 0; }
p { margin: .4rem 0; max-width: 44rem; }
a { color: var(--accent); text-decoration: none; }
a:hover { text-decoration: underline; }
.eyebrow, nav, .facts, .note, footer { color: var(--muted); font-size: .875rem; }
.eyebrow { letter-spacing: .02em; }
nav { display: flex; flex-wrap: wrap; gap: .2rem 1.2rem; margin-top: 1.4rem; }
.state { display: inline-block; padding: .1rem .6rem; border-radius: 1rem; font-weight: 600;
  color: #fff; background: var(--wait); margin-right: .5rem; }
.state.good { background: var(--good); } .state.bad { background: var(--bad); }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(10rem, 1fr));
  gap: 1px; margin: 2rem 0 0; padding: 1px; background: var(--rule); border-radius: .5rem;
  overflow: hidden; }
.tile { background: #fff; padding: .9rem 1.1rem; }
.tile b { display: block; font: 600 1.5rem/1.25 var(--serif); }
.tile span { color: var(--muted); font-size: .85rem; }
.figures { display: grid; gap: 2.8rem 2.5rem;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 28rem), 1fr)); }
.scroll + .figures { margin-top: 2.2rem; }
figure { margin: 0; break-inside: avoid; min-width: 0; max-width: 37rem; }
figure svg { display: block; width: 100%; height: auto; margin: .3rem 0 0; }
figure svg text { font-family: var(--sans) !important; }
.legend { display: flex; flex-wrap: wrap; gap: .1rem 1.1rem; margin: .25rem 0 0; padding: 0;
  list-style: none; font-size: .85rem; color: var(--muted); }
.legend li { display: flex; align-items: center; gap: .4rem; }
.legend svg { width: 1.5rem; height: .7rem; margin: 0; flex: none; }
.sight { display: block; max-width: 100%; height: auto; margin: 0 0 1.2rem; }
.turn { width: 100%; height: min(38rem, 80vh); border: 1px solid var(--rule); }
.note { margin: .5rem 0 0; line-height: 1.45; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .875rem; line-height: 1.4; margin: .6rem 0 0;
  min-width: min(100%, 28rem); }
th { text-align: left; font-weight: 500; color: var(--muted); border-bottom: 1px solid #b9c0c6;
  vertical-align: bottom; white-space: nowrap; }
th, td { padding: .34rem 1.1rem .34rem 0; }
td { border-bottom: 1px solid var(--rule); vertical-align: top; }
.num { text-align: right; white-space: nowrap; }
.unit { white-space: nowrap; }
figure table { font-size: .8rem; } figure th, figure td { padding-right: .7rem; }
figure td:nth-child(n+5) { white-space: normal; }
.name { font-family: var(--mono); font-size: .93em; min-width: 11rem; }
.pass { color: var(--good); font-weight: 600; } .fail { color: var(--bad); font-weight: 600; }
.problem { color: var(--bad); border-left: 3px solid var(--bad); padding: .2rem 0 .2rem .8rem; }
details { margin: .8rem 0; } summary { cursor: pointer; color: var(--accent); }
pre { background: var(--soft); padding: 1rem 1.1rem; border-radius: .4rem; overflow-x: auto;
  font: .8rem/1.5 var(--mono); margin: .6rem 0; }
footer { margin-top: 4rem; padding-top: 1rem; border-top: 1px solid var(--rule); }
@media (max-width: 40rem) { body { padding: 1.5rem 1rem 3rem; } h2 { margin-top: 2.6rem; }
  .tiles { grid-template-columns: 1fr 1fr; } .tile { padding: .7rem .8rem; }
  th, td { padding-right: .8rem; } }
@page { size: A4; margin: 16mm; }
@media print { video, .turn { display: none; } .sight { break-inside: avoid; }
  body { padding: 0; max-width: none; font-size: 9.5pt; } nav { display: none; }
  h2 { break-after: avoid; margin-top: 2rem; } .figures { display: block; }
  figure { max-width: 13cm; margin-bottom: 1.8rem; }
  .scroll { overflow: visible; } table { font-size: 8pt; }
  thead { display: table-header-group; } tr { break-inside: avoid; }
  .state, .tiles { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  details::details-content { content-visibility: visible; height: auto; }
  pre { white-space: pre-wrap; font-size: 7.5pt; } }
"""
