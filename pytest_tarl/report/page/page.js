"use strict";
(() => {
  const VALUES = ["#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"];
  const CHANGE = {
    light: ["#8f3f02", "#c2690f", "#e79d4d", "#f6d2a8", "#f4f2ee", "#b9d3ea", "#6ea6d6", "#2f75b5", "#154a80"],
    dark: ["#ffbd70", "#df8c36", "#a5611f", "#5f4023", "#2a2e34", "#254766", "#2f70a8", "#5ea4e0", "#a4d2ff"],
  };
  const WORLDS = ["offline", "online", "difference"];
  const WIDE = 760, WIDE_PRINT = 600;     // px from which the three panels stand side by side
  const HEADROOM = 46, GAP = 26, ROW_GAP = 34, FOOT = 44, RIGHT = 10, WORLD_GAP = 44;
  const HALF_SITE = 0.5;

  const page = JSON.parse(document.getElementById("tarl-data").textContent);
  const root = document.documentElement;
  const darkness = matchMedia("screen and (prefers-color-scheme: dark)");
  let printing = false;

  const colour = name => getComputedStyle(root).getPropertyValue(`--${name}`).trim();
  const stops = colours => colours.map((c, i) => [i / (colours.length - 1), c]);
  const isWide = width => width >= (printing ? WIDE_PRINT : WIDE);
  const change = () => CHANGE[darkness.matches && !printing ? "dark" : "light"];
  const safe = text => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
  const amount = (value, sign = false) => {
    if (value === null) return "n/a";
    const size = Math.abs(value);
    const text = value === 0 || (size >= 0.1 && size < 1000) ? size.toFixed(2)
      : size >= 1000 && size < 1e6 ? size.toFixed(0) : String(Number(size.toPrecision(3)));
    return (value < 0 ? "−" : sign ? "+" : "") + text;
  };

  async function inflate(element) {
    const packed = Uint8Array.from(atob(element.textContent.trim()), c => c.charCodeAt(0));
    return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).text();
  }

  async function loadLibrary() {
    const element = document.getElementById("tarl-library");
    const script = document.createElement("script");
    script.textContent = await inflate(element);
    document.head.append(script);
    script.remove();
    element.remove();
  }

  function characterWidth(font) {
    const context = document.createElement("canvas").getContext("2d");
    context.font = font;
    return context.measureText("0").width;
  }

  /** Code lines as tick labels: line number and code in two columns, elided to `room` pixels; numbers only without room. */
  function siteLabels(sites, room, size) {
    const digits = Math.max(...sites.map(([line]) => String(line).length));
    const numbers = sites.map(([line]) => String(line).padStart(digits, "\u00a0"));
    const fit = Math.floor(room / characterWidth(`${size}px ${colour("mono")}`)) - digits - 3;
    if (fit < 12) return numbers;
    const folded = sites.map(([, code]) => code.replace(/\s+/g, " "));
    const longest = Math.min(fit, Math.max(...folded.map(code => code.length)));
    const cut = folded.map(code => (code.length > longest ? code.slice(0, longest - 1) + "…" : code));
    return cut.map((code, i) => `${numbers[i]}  ${safe(code)}${"\u00a0".repeat(longest - code.length)}\u00a0`.replace(/ /g, "\u00a0"));
  }

  const baseLayout = width => ({
    width,
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
    font: { family: colour("sans"), size: 12, color: colour("muted") },
    hoverlabel: { bgcolor: colour("raised"), bordercolor: colour("rule"), align: "left",
                  font: { family: colour("sans"), size: 12.5, color: colour("ink") } },
    dragmode: false, showlegend: false, shapes: [], annotations: [],
  });

  const difference = row => row.online.map((values, n) => values.map((value, i) =>
    value === null || row.offline[n][i] === null ? null : value - row.offline[n][i]));

  /** Where the panels stand, in pixels from the top left: three side by side, or one below the other. */
  function panels(figure, width, left) {
    const wide = isWide(width);
    const height = Math.max(84, Math.min(figure.sites.length * (printing ? 17 : 24), Math.max(640, figure.sites.length * 13)));
    const across = wide ? (width - left - RIGHT - 2 * GAP) / 3 : width - left - RIGHT;
    const placed = [];
    WORLDS.forEach((world, i) => figure.rows.forEach((row, j) => {
      const rank = wide ? j : i * figure.rows.length + j;
      const top = HEADROOM + rank * (height + ROW_GAP) + (wide ? 0 : i * WORLD_GAP);
      placed.push({ world, row, top, height, first: j === 0, last: j === figure.rows.length - 1,
                    left: left + (wide ? i * (across + GAP) : 0), across, leftmost: !wide || i === 0 });
    }));
    return { placed, wide, total: Math.max(...placed.map(p => p.top)) + height + FOOT };
  }

  function hoverTexts(figure, row, world, values) {
    return values.map((line, n) => line.map((value, i) => {
      if (value === null) return "";
      const [number, code] = figure.sites[n];
      const where = [figure.axis.names[i], row.title].filter(Boolean).join(", ");
      const named = world === "difference" ? `difference ${amount(value, true)}` : `${titles().plain[world]} ${amount(value)}`;
      return `<b>${safe(named)}</b><br>${number}  ${safe(code.length > 64 ? code.slice(0, 63) + "…" : code)}<br>${safe(where)}`;
    }));
  }

  const titles = () => ({
    plain: { offline: "designed", online: "deployed", difference: "difference" },
    long: { offline: "Designed",
            online: page.world === "deployed" ? "Deployed" : `Deployed, ${page.world}`,
            difference: "Difference, deployed − designed" },
  });

  function heat(figure, panel, k) {
    const change_ = panel.world === "difference";
    const values = change_ ? difference(panel.row) : panel.row[panel.world];
    const reach = figure.reach || 1;
    const [low, high] = figure.range;
    return {
      type: "heatmap", x: figure.axis.centres, y: figure.sites.map((_, n) => n), z: values,
      xaxis: `x${k}`, yaxis: `y${k}`, zmin: change_ ? -reach : low, zmax: change_ ? reach : high > low ? high : low + 1,
      colorscale: stops(change_ ? change() : VALUES), showscale: false, xgap: 1, ygap: 1, hoverongaps: false,
      text: hoverTexts(figure, panel.row, panel.world, values), hovertemplate: "%{text}<extra></extra>",
    };
  }

  function novelMarks(figure, panel, k) {
    const inside = figure.axis.centres.filter(x => panel.row.novel.some(([a, b]) => a < x && x < b));
    return { type: "scatter", mode: "markers", x: inside, y: inside.map(() => -HALF_SITE), xaxis: `x${k}`, yaxis: `y${k}`,
             cliponaxis: false, hoverinfo: "skip", marker: { symbol: "x-thin", size: 7, line: { width: 1.6, color: colour("ink") } } };
  }

  function outlines(panel, sites, k) {
    const box = (ranges, line, inset) => ranges.map(([x0, x1]) => ({
      type: "rect", xref: `x${k}`, yref: `y${k}`, x0, x1, y0: -HALF_SITE + inset, y1: sites - HALF_SITE - inset, line, layer: "above" }));
    return [...box(panel.row.paper, { color: colour("ink"), width: 2, dash: "2px,3px" }, sites * 0.035),
            ...box(panel.row.region, { color: colour("ink"), width: 2 }, 0)];
  }

  function axes(figure, panel, labels, layout, k) {
    const { width, height } = layout;
    const edge = figure.axis.centres.length > 1 ? (figure.axis.centres[1] - figure.axis.centres[0]) / 2 : 0.5;
    const shared = { zeroline: false, showgrid: false, fixedrange: true, ticks: "" };
    layout[`xaxis${k}`] = {
      ...shared, anchor: `y${k}`, domain: [panel.left / width, (panel.left + panel.across) / width],
      range: [figure.axis.centres[0] - edge, figure.axis.centres.at(-1) + edge], nticks: 6,
      showticklabels: panel.last, tickfont: { size: 11.5 },
      title: { text: panel.last ? safe(figure.axis.title) : "", standoff: 6, font: { size: 12.5 } },
      ...(figure.axis.ticks && { tickmode: "array", tickvals: figure.axis.centres, ticktext: figure.axis.ticks.map(safe) }),
    };
    layout[`yaxis${k}`] = {
      ...shared, anchor: `x${k}`, domain: [1 - (panel.top + panel.height) / height, 1 - panel.top / height],
      range: [figure.sites.length - HALF_SITE, -HALF_SITE], showticklabels: panel.leftmost,
      tickmode: "array", tickvals: figure.sites.map((_, n) => n), ticktext: labels,
      tickfont: { family: colour("mono"), size: Math.min(11.5, (0.85 * panel.height) / figure.sites.length), color: colour("ink") },
    };
  }

  function panelTitles(panel, layout, wide) {
    const at = (text, lift, style) => ({
      text, showarrow: false, xref: "paper", yref: "paper", xanchor: "left", yanchor: "bottom", align: "left",
      x: panel.left / layout.width, y: 1 - (panel.top - lift) / layout.height, font: style });
    const found = [];
    const named = panel.across < 200 && panel.world === "difference" ? "Difference" : titles().long[panel.world];
    if (panel.first) found.push(at(safe(named), panel.row.title ? 19 : 3, { size: 13.5, color: colour("ink") }));
    if (panel.row.title && (panel.leftmost || !wide)) found.push(at(safe(panel.row.title), 3, { size: 12 }));
    return found;
  }

  function drawUtility(element, width) {
    const figure = page.utility[Number(element.dataset.list)];
    const labels = siteLabels(figure.sites, isWide(width) ? Math.min(width * 0.28, 330) : 0, 11.5);
    const left = 12 + Math.max(...labels.map(text => text.replace(/&\w+;/g, "x").length)) * characterWidth(`11.5px ${colour("mono")}`);
    const { placed, wide, total } = panels(figure, width, left);
    const layout = { ...baseLayout(width), height: total, margin: { l: 0, r: 0, t: 0, b: 0 } };
    const traces = [];
    placed.forEach((panel, i) => {
      const k = i === 0 ? "" : i + 1;
      axes(figure, panel, labels, layout, k);
      layout.annotations.push(...panelTitles(panel, layout, wide));
      traces.push(heat(figure, panel, k));
      if (panel.world !== "offline" && panel.row.novel.length) traces.push(novelMarks(figure, panel, k));
      if (panel.world === "difference") layout.shapes.push(...outlines(panel, figure.sites.length, k));
    });
    return [traces, layout];
  }

  const STYLES = {
    offline: { dash: "solid", width: 2.5, colour: "off" }, online: { dash: "solid", width: 2.5, colour: "on" },
    search: { dash: "dot", width: 1.8, colour: "search" }, repaired: { dash: "solid", width: 2.5, colour: "repaired" },
    nominal: { dash: "dash", width: 2, colour: "nominal" },
  };
  const SEARCH_DASHES = ["dot", "dashdot", "longdash"];

  function curveTraces(curve, rank) {
    const style = STYLES[curve.kind];
    const episodes = curve.mean.map((_, i) => i + 1);
    const tone = colour(style.colour);
    const line = {
      type: "scatter", mode: "lines", x: episodes, y: curve.mean, name: safe(curve.name), legendgroup: curve.name,
      line: { color: tone, width: style.width, dash: curve.kind === "search" ? SEARCH_DASHES[rank % 3] : style.dash },
      customdata: curve.totals.map((total, i) => [amount(total), safe(curve.labels[i] ?? ""), amount(curve.mean[i])]),
      hovertemplate: `<b>${safe(curve.name)} %{customdata[2]}</b><br>episode %{x}: %{customdata[0]}  %{customdata[1]}<extra></extra>`,
    };
    const dots = {
      type: "scatter", mode: "markers", x: episodes, y: curve.totals, legendgroup: curve.name, showlegend: false,
      hoverinfo: "skip", marker: { color: tone, size: 3.5, opacity: 0.38 },
    };
    return [dots, line];
  }

  function drawCurves(element, width) {
    const lengths = kind => page.curves.filter(kind).map(curve => curve.mean.length);
    const longest = Math.max(...lengths(curve => curve.kind !== "offline")) || Math.max(...lengths(() => true));
    const layout = {
      ...baseLayout(width), height: isWide(width) ? (printing ? 330 : 400) : 440, margin: { l: 52, r: 12, t: 12, b: 48 }, showlegend: true,
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", font: { size: 12.5, color: colour("ink") }, itemsizing: "constant" },
      xaxis: { title: { text: "episode", standoff: 8 }, range: [0.5, longest + 0.5], gridcolor: colour("rule"), showgrid: false,
               zeroline: false, fixedrange: true, linecolor: colour("rule"), showline: true },
      yaxis: { title: { text: "total reward per episode", standoff: 8 }, gridcolor: colour("rule"), zeroline: false,
               fixedrange: true, nticks: 7 },
      hovermode: "closest",
    };
    if (page.offline !== null) {
      layout.shapes.push({ type: "rect", xref: "paper", x0: 0, x1: 1, yref: "y", y0: page.offline - page.tolerance,
                           y1: page.offline + page.tolerance, line: { width: 0 }, fillcolor: colour("band"), layer: "below" });
    }
    let searches = 0;
    return [page.curves.flatMap(curve => curveTraces(curve, curve.kind === "search" ? searches++ : 0)), layout];
  }

  const DRAWINGS = { utility: drawUtility, curves: drawCurves };

  async function draw(element) {
    const width = Math.floor(printing ? Math.min(element.clientWidth || 680, 700) : element.clientWidth);
    if (!width) return;
    element.querySelector(".waiting")?.remove();
    const [traces, layout] = DRAWINGS[element.dataset.figure](element, width);
    await Plotly.react(element, traces, layout, { displayModeBar: false, responsive: false, showTips: false });
    element.dataset.drawn = String(width);
  }

  function paintLegends() {
    const gradient = colours => `linear-gradient(to right, ${colours.join(", ")})`;
    document.querySelectorAll(".bar.values").forEach(bar => { bar.style.background = gradient(VALUES); });
    document.querySelectorAll(".bar.change").forEach(bar => { bar.style.background = gradient(change()); });
  }

  const plots = [...document.querySelectorAll(".plot")];
  async function drawAll() {
    paintLegends();
    for (const plot of plots) await draw(plot);
  }

  function watch() {
    let timer = 0;
    const soon = () => { clearTimeout(timer); timer = setTimeout(drawAll, 120); };
    let before = root.clientWidth;
    addEventListener("resize", () => { if (root.clientWidth !== before) { before = root.clientWidth; soon(); } });
    darkness.addEventListener("change", soon);
    addEventListener("beforeprint", () => { printing = true; drawAll(); });
    addEventListener("afterprint", () => { printing = false; drawAll(); });
  }

  function tabs() {
    const buttons = [...document.querySelectorAll("[role=tab]")];
    const show = chosen => buttons.forEach((button, i) => {
      button.setAttribute("aria-selected", String(i === chosen));
      button.tabIndex = i === chosen ? 0 : -1;
      document.getElementById(button.getAttribute("aria-controls")).hidden = i !== chosen;
    });
    const pick = async i => {
      show(i);
      buttons[i].focus();
      for (const plot of plots) if (plot.closest(`#list-${i}`) && plot.dataset.drawn !== String(plot.clientWidth)) await draw(plot);
    };
    buttons.forEach((button, i) => {
      button.addEventListener("click", () => pick(i));
      button.addEventListener("keydown", event => {
        const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (step) { event.preventDefault(); pick((i + step + buttons.length) % buttons.length); }
      });
    });
    if (buttons.length) show(0);
  }

  async function main() {
    tabs();
    try {
      await loadLibrary();
      await drawAll();
      watch();
      root.dataset.report = "drawn";
    } catch (error) {
      root.dataset.report = "failed";
      document.querySelectorAll(".waiting").forEach(p => { p.textContent = `This browser cannot draw the figure: ${error.message}`; });
      console.error(error);
    }
  }
  main();
})();
