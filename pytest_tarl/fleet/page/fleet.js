"use strict";
(() => {
  const page = JSON.parse(document.getElementById("tarl-data").textContent);
  const root = document.documentElement;
  const MOST_ROWS = 20, BINS = 60, LABEL_ROOM = 150, SQUARE = 8, GAP = 1;
  const WORSE = "165, 77, 8", BETTER = "37, 104, 168";
  const at = id => document.getElementById(id);
  const colour = name => getComputedStyle(root).getPropertyValue(`--${name}`).trim();
  const number = value => value === null ? "n/a" : Number(value.toPrecision(4)).toLocaleString("en", { maximumSignificantDigits: 4 }).replace("-", "−");
  const day = time => time ? new Date(time * 1000).toISOString().slice(0, 16).replace("T", " ") : "no time";
  const evidence = log2 => log2 >= 10 ? `2^${Math.round(log2)}` : number(2 ** log2);
  const plural = (count, word) => `${count.toLocaleString("en")} ${word}${count === 1 ? "" : "s"}`;

  function element(kind, attributes = {}, ...children) {
    const made = document.createElement(kind);
    for (const [name, value] of Object.entries(attributes)) {
      if (name === "onclick") made.addEventListener("click", value);
      else if (value !== null && value !== false) made.setAttribute(name, value === true ? "" : value);
    }
    made.append(...children);
    return made;
  }

  function drawn(kind, attributes, text = "") {
    const made = document.createElementNS("http://www.w3.org/2000/svg", kind);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    if (text) made.textContent = text;
    return made;
  }

  /* ---- map of groups: the last column across, all others down ---- */
  const reach = Math.max(1e-9, ...page.groups.map(one => Math.abs(one.reward - page.recorded)));
  const shade = one => {
    const change = (one.reward - page.recorded) / reach;
    return `rgba(${change < 0 ? WORSE : BETTER}, ${(0.85 * Math.abs(change)).toFixed(3)})`;
  };
  const sign = one => one.result === "degraded" ? "▼" : one.result === "drifted" ? "◆" : one.named ? "•" : "";

  function showGroup(one, tile) {
    for (const other of document.querySelectorAll(".tile[aria-pressed=true]")) other.setAttribute("aria-pressed", "false");
    if (tile) tile.setAttribute("aria-pressed", "true");
    const name = one.values.map((value, n) => `${page.by[n]} ${value}`).join(", ") || "all missions";
    const since = one.since ? `; changed before ${day(one.since)}, evidence ${evidence(one.evidence)}` : "";
    at("group").replaceChildren(
      element("strong", {}, name), `: ${plural(one.missions, "mission")} of ${plural(one.robots, "robot")}, `,
      `pass rate ${number(100 * one.pass)} % (${number(100 * one.passLow)} to ${number(100 * one.passHigh)}), `,
      `mean reward ${number(one.reward)} (${number(one.low)} to ${number(one.high)}; recorded ${number(page.recorded)}). `,
      one.verdict, since, one.where ? `. Where: ${one.where}` : "", ".");
  }

  function map() {
    const name = one => one.values.slice(0, -1).join(" ");
    const across = [...new Set(page.groups.map(one => one.values.at(-1) ?? ""))];
    const down = [...new Set(page.groups.map(name))];
    const flat = down.length === 1;
    const wide = flat ? Math.min(across.length, 40) : across.length;
    const grid = element("div", { class: "tiles", style: `grid-template-columns: max-content repeat(${wide}, max-content)` });
    const cells = new Map(page.groups.map(one => [JSON.stringify([name(one), one.values.at(-1) ?? ""]), one]));
    const tile = (row, column) => {
      const one = cells.get(JSON.stringify([row, column]));
      if (!one) return element("span", { class: "tile empty" });
      const label = `${one.values.join(" ") || "all missions"}: ${one.verdict}, mean reward ${number(one.reward)}`;
      return element("button", {
        class: `tile${one.found ? " found" : ""}`, title: label, "aria-label": label, "aria-pressed": "false",
        style: `background: ${shade(one)}`, onclick: event => showGroup(one, event.currentTarget) }, sign(one));
    };
    if (!flat) {
      grid.append(element("span"), ...across.map(column => element("span", { class: "top", title: column }, column)));
      for (const row of down) {
        grid.append(element("span", { class: "label" }, row), ...across.map(column => tile(row, column)));
      }
    } else {
      for (let begin = 0; begin < across.length; begin += wide) {
        const some = across.slice(begin, begin + wide), blank = Array.from({ length: wide - some.length }, () => element("span"));
        grid.append(element("span"), ...some.map(column => element("span", { class: "top", title: column }, column)), ...blank.map(one => one.cloneNode()));
        grid.append(element("span", { class: "label" }, down[0]), ...some.map(column => tile(down[0], column)), ...blank);
      }
    }
    at("map").replaceChildren(grid);
    const bar = `linear-gradient(90deg, rgba(${WORSE}, .85), rgba(${WORSE}, 0), rgba(${BETTER}, 0), rgba(${BETTER}, .85))`;
    at("scale").replaceChildren(
      element("span", { class: "key" }, element("span", { class: "bar", style: `background: ${bar}` }),
        element("span", { class: "ends" }, element("b", {}, `−${number(reach)}`), element("span", {}, "mean reward minus recorded reward"), element("b", {}, `+${number(reach)}`))),
      element("span", { class: "key" }, "▼ degraded"), element("span", { class: "key" }, "◆ drifted"), element("span", { class: "key" }, "• changed in time"));
    const worst = page.groups.reduce((least, one) => one.reward < least.reward ? one : least, page.groups[0]);
    showGroup(page.groups.find(one => one.found) ?? worst);
  }

  /* ---- onsets: robots as columns, groups as marks above ---- */
  function timeline() {
    const [first, last] = page.period, span = Math.max(1, last - first);
    const WIDTH = 1000, LEFT = 40, FOOT = 20, TALL = 110;
    const groups = page.groups.filter(one => one.named && one.since).sort((a, b) => a.since - b.since);
    const robots = page.named.filter(one => one.time);
    const top = 16 + (groups.length ? 34 : 0), height = top + TALL + FOOT;
    const x = time => LEFT + (WIDTH - LEFT - 10) * (time - first) / span;
    const svg = drawn("svg", { viewBox: `0 0 ${WIDTH} ${height}`, role: "img", "aria-label": `${plural(robots.length, "robot")} and ${plural(groups.length, "group")} with an onset` });
    const counts = new Array(BINS).fill(0);
    for (const one of robots) counts[Math.min(BINS - 1, Math.max(0, Math.floor(BINS * (one.time - first) / span)))] += 1;
    const most = Math.max(1, ...counts);
    counts.forEach((count, n) => {
      if (!count) return;
      const bar = drawn("rect", { class: "robots", x: x(first + span * n / BINS) + 0.5, width: (WIDTH - LEFT - 10) / BINS - 1, y: top + TALL * (1 - count / most), height: TALL * count / most });
      bar.append(drawn("title", {}, `${plural(count, "robot")} from ${day(first + span * n / BINS)}`));
      svg.append(bar);
    });
    groups.forEach(one => {
      const mark = drawn("line", { class: "group", x1: x(one.since), x2: x(one.since), y1: 20, y2: top + TALL });
      mark.append(drawn("title", {}, `${one.values.join(" ")}: ${day(one.since)}`));
      mark.addEventListener("click", () => showGroup(one));
      svg.append(mark);
    });
    const labels = [];                      // groups that begin at about the same time share a label
    for (const one of groups) {
      const last = labels.at(-1);
      if (last && x(one.since) - x(last.one.since) < LABEL_ROOM) last.more += 1;
      else labels.push({ one, more: 0 });
    }
    labels.forEach(({ one, more }) => {
      const right = x(one.since) > WIDTH / 2, text = one.values.join(" ") + (more ? ` and ${more} more` : "");
      svg.append(drawn("text", { x: x(one.since) + (right ? -4 : 4), y: 30, "text-anchor": right ? "end" : "start" }, text));
    });
    svg.append(drawn("line", { class: "axis", x1: LEFT, x2: WIDTH - 10, y1: top + TALL, y2: top + TALL }));
    svg.append(drawn("text", { x: LEFT - 6, y: top + 10, "text-anchor": "end" }, String(most)));
    for (let n = 0; n <= 4; n += 1) {
      const anchor = n === 0 ? "start" : n === 4 ? "end" : "middle";
      svg.append(drawn("text", { x: x(first + span * n / 4), y: height - 4, "text-anchor": anchor }, day(first + span * n / 4).slice(0, 10)));
    }
    at("timeline").replaceChildren(first ? svg : element("p", { class: "absent" }, "The missions have no dates, so there is no timeline."));
  }

  /* ---- cells in which most named robots differ ---- */
  function cells() {
    const most = Math.max(1, ...page.cells.map(one => one.robots + one.groups));
    at("cells").replaceChildren(...(page.cells.length ? page.cells.map(one => element("div", { class: "cell" },
      element("span", {}, one.name), element("i", { style: `width: ${100 * (one.robots + one.groups) / most}%` }),
      element("span", { class: "weak" }, `${plural(one.robots, "robot")}, ${plural(one.groups, "group")}`)))
      : [element("p", { class: "absent" }, "No cell stands out.")]));
  }

  /* ---- robots: a square each, a table of those with most evidence, and one in detail ---- */
  const robots = page.robots, total = robots.name.length;
  const most = n => Math.max(robots.world[n], robots.bound[n]);
  const named = new Map(page.named.map(one => [one.index, one]));
  const order = Array.from({ length: total }, (_, n) => n).sort((a, b) => named.has(b) - named.has(a) || most(b) - most(a) || a - b);
  let columns = 1;

  function dots() {
    const canvas = at("dots"), ratio = devicePixelRatio || 1, step = (total > 3000 ? SQUARE : 1.5 * SQUARE) + GAP;
    const width = Math.max(step, canvas.parentElement.clientWidth);
    columns = Math.max(1, Math.floor(width / step));
    const height = Math.ceil(total / columns) * step;
    canvas.width = width * ratio; canvas.height = height * ratio; canvas.style.height = `${height}px`;
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    const shades = { none: colour("rule"), weak: colour("search"), strong: colour("on") };
    for (let n = 0; n < total; n += 1) {
      context.fillStyle = shades[named.has(n) ? "strong" : most(n) >= page.weak ? "weak" : "none"];
      context.fillRect((n % columns) * step, Math.floor(n / columns) * step, step - GAP, step - GAP);
    }
    const under = event => {
      const box = canvas.getBoundingClientRect();
      const found = Math.floor((event.clientY - box.top) / step) * columns + Math.floor((event.clientX - box.left) / step);
      return found < total ? found : -1;
    };
    canvas.onmousemove = event => { const n = under(event); at("dot").textContent = n < 0 ? "\u00a0" : `${robots.name[n]}, evidence ${evidence(most(n))}`; };
    canvas.onclick = event => { const n = under(event); if (n >= 0) open(n); };
  }

  function table() {
    const text = at("search").value.trim().toLowerCase();
    const found = text ? order.filter(n => robots.name[n].toLowerCase().includes(text)) : order;
    at("count").textContent = `${found.length.toLocaleString("en")} of ${plural(total, "robot")}${found.length > MOST_ROWS ? `, the first ${MOST_ROWS} shown` : ""}`;
    at("table").tBodies[0].replaceChildren(...found.slice(0, MOST_ROWS).map(n => {
      const one = named.get(n);
      return element("tr", {},
        element("td", {}, element("button", { onclick: () => open(n) }, robots.name[n])),
        element("td", { class: "number" }, robots.missions[n].toLocaleString("en")),
        element("td", { class: "number" }, `${number(100 * robots.passed[n] / robots.missions[n])} %`),
        element("td", { class: "number" }, evidence(most(n))),
        element("td", {}, one?.mission ? `mission ${one.mission}, ${day(one.time)}` : ""),
        element("td", {}, one?.where ?? ""));
    }));
  }

  function open(n) {
    const hash = `#robot=${encodeURIComponent(robots.name[n])}`;
    if (location.hash === hash) show(); else location.hash = hash;
  }

  function show() {
    const wanted = location.hash.startsWith("#robot=") ? decodeURIComponent(location.hash.slice(7)) : null;
    const n = wanted === null ? -1 : robots.name.indexOf(wanted), card = at("robot");
    card.hidden = n < 0;
    if (n < 0) return;
    const one = named.get(n);
    const rows = (one?.cells ?? []).map(cell => element("tr", {}, element("td", {}, cell.name),
      element("td", { class: "number" }, number(cell.mean)), element("td", { class: "number" }, `± ${number(cell.error)}`)));
    card.replaceChildren(
      element("h3", {}, robots.name[n]),
      element("p", {}, `${robots.passed[n].toLocaleString("en")} of ${plural(robots.missions[n], "mission")} passed. Evidence that its missions differ from the recording: ${evidence(robots.world[n])}; evidence that they are below a recorded bound: ${evidence(robots.bound[n])}. `,
        one ? `Named${one.mission ? `; changed before mission ${one.mission} (${day(one.time)})` : ""}. ${one.where ? `Where: ${one.where}.` : ""}` : "Not named."),
      ...(one?.like?.length ? [element("p", {}, "Robots with similar drifts: ", ...one.like.flatMap(name => [element("a", { href: `#robot=${encodeURIComponent(name)}` }, name), " "]))] : []),
      ...(rows.length ? [element("table", { class: "plain narrow" }, element("thead", {}, element("tr", {}, element("th", {}, "Cell"), element("th", { class: "number" }, "Reward per step, minus recorded"), element("th", { class: "number" }, "Standard error"))), element("tbody", {}, ...rows))] : []),
      element("p", { class: "label" }, "To show its missions: ", element("code", {}, `${page.command} --robot ${quoted(robots.name[n])} --html ${quoted(`${robots.name[n]}.html`)}`)));
    card.scrollIntoView({ block: "nearest" });
  }

  const quoted = text => /^[\w.,/:=@%+-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;

  map(); timeline(); cells(); dots(); table(); show();
  at("search").addEventListener("input", table);
  addEventListener("hashchange", show);
  addEventListener("resize", dots);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", dots);
  root.dataset.report = "drawn";
})();
