"""One look for figures, reports and pages: colours, lines and letters, readable in print.

Colours of curves stand out from white paper by 3:1 at least, the contrast of WCAG 2.1 for graphics,
and from each other also to eyes without red, green or blue cones. Neighbours differ in their dashes
as well, for prints in grey. A test computes both.
"""

import warnings

# a character that the fonts lack, as an emoji in a title, is drawn as a box
warnings.filterwarnings("ignore", message=r"Glyph \d+ .*missing from")

INK, MUTED, RULE, FRAME = "#1c2126", "#5b6570", "#e4e7ea", "#b9c0c6"
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#332288", "#cc79a7", "#882255", INK)
REFERENCE_COLOURS = ("#8a6d00", "#a0527d", "#3c7d78")
# solid, long dashes, dots, dashes with dots: as matplotlib and SVG know them [line widths]
DASHES: tuple[tuple[float, ...], ...] = ((), (5.0, 1.8), (1.2, 1.4), (5.0, 1.6, 1.2, 1.6))
# as many lines as differ in colour and dashes together
MAX_LINES = len(COLOURS) * len(DASHES)

MATPLOTLIB: dict[str, object] = {
    "font.size": 10,
    "font.family": "sans-serif",
    "axes.edgecolor": FRAME,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.labelcolor": MUTED,
    "grid.color": RULE,
    "grid.linewidth": 0.7,
    "text.color": INK,
    # titles and names are text: a dollar begins no formula
    "text.parse_math": False,
    "xtick.color": FRAME,
    "ytick.color": FRAME,
    "xtick.labelcolor": MUTED,
    "ytick.labelcolor": MUTED,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "lines.linewidth": 1.6,
    "lines.solid_joinstyle": "round",
    "legend.frameon": False,
    "legend.fontsize": 9,
    "legend.handlelength": 2.6,
    "path.simplify": True,
    # letters stay letters, which can be searched; the same figure has the same bytes
    "svg.fonttype": "none",
    "svg.hashsalt": "crashpost",
    "pdf.fonttype": 42,
}


def line_style(number: int) -> tuple[str, tuple[float, ...]]:
    """Colour and dashes of a figure's line, counted from 0; MAX_LINES of them differ."""
    return COLOURS[number % len(COLOURS)], DASHES[number % len(DASHES)]


CSS = (
    f"""
:root {{ --ink: {INK}; --muted: {MUTED}; --rule: {RULE}; --soft: #f6f7f8; --accent: {COLOURS[0]};"""
    """
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
.tiles { display: flex; flex-wrap: wrap; gap: 1px; margin: 2rem 0 0; padding: 1px;
  background: var(--rule); border-radius: .5rem;
  overflow: hidden; }
.tile { flex: 1 1 10rem; background: #fff; padding: .9rem 1.1rem; }
.tile b { display: block; font: 600 1.5rem/1.25 var(--serif); }
.tile span { color: var(--muted); font-size: .85rem; }
.tile.bad b { color: var(--bad); }
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
figure .num, figure td, figure th { white-space: normal; }
figure td:first-child { min-width: 5.5rem; }
.name { font-family: var(--mono); font-size: .93em; min-width: 11rem; }
.pass { color: var(--good); font-weight: 600; } .fail { color: var(--bad); font-weight: 600; }
.missed td { background: #fbeeea; } .missed td:first-child { box-shadow: inset 3px 0 var(--bad);
  padding-left: .6rem; }
.problem { color: var(--bad); border-left: 3px solid var(--bad); padding: .2rem 0 .2rem .8rem; }
details { margin: .8rem 0; } summary { cursor: pointer; color: var(--accent); }
pre { background: var(--soft); padding: 1rem 1.1rem; border-radius: .4rem; overflow-x: auto;
  font: .8rem/1.5 var(--mono); margin: .6rem 0; }
footer { margin-top: 4rem; padding-top: 1rem; border-top: 1px solid var(--rule); }
@media (max-width: 40rem) { body { padding: 1.5rem 1rem 3rem; } h2 { margin-top: 2.6rem; }
  .tile { flex-basis: 40%; padding: .7rem .8rem; } figure .scroll td:last-child { min-width: 0; }
  th, td { padding-right: .8rem; } .scroll td:last-child:not(.num) { min-width: 13rem; } }
@page { size: A4; margin: 16mm; }
@media print { video.sight, .turn { display: none; } .sight { break-inside: avoid; }
  body { padding: 0; max-width: none; font-size: 9.5pt; } nav { display: none; }
  h2 { break-after: avoid; margin-top: 2rem; }
  .figures { display: block; columns: 2; column-gap: 8mm; }
  figure { max-width: none; margin-bottom: 1.2rem; } h3 { break-after: avoid; }
  #deck { display: none; }
  .scroll { overflow: visible; } table { font-size: 8pt; } .name { min-width: 0; }
  .scroll td:last-child:not(.num) { min-width: 4.2cm; }
  thead { display: table-header-group; } tr { break-inside: avoid; }
  .state, .tiles, .missed td { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  details::details-content { content-visibility: visible; height: auto; }
  pre { white-space: pre-wrap; font-size: 7.5pt; } }
"""
)
