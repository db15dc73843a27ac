"use strict";
// The table of a batch: filtered, sorted, and built a page at a time as it scrolls into view.
(() => {
  const PAGE = 100;
  const WORDS = { ok: "done", failed: "failed", skipped: "unchanged" };
  const all = JSON.parse(document.getElementById("data").textContent);
  const find = (id) => document.getElementById(id);
  const body = find("rows");
  let order = { key: null, up: true };
  let shown = [];
  let built = 0;

  const element = (name, className, text) => {
    const made = document.createElement(name);
    if (className) made.className = className;
    if (text !== undefined) made.textContent = text;
    return made;
  };
  const linked = (row, child) => {
    if (!row.report) return child;
    const link = element("a");
    link.href = row.report;
    link.append(child);
    return link;
  };
  const picture = (row) => {
    const cell = element("td", "picture");
    if (!row.preview) return cell;
    const image = element("img");
    image.loading = "lazy";
    image.alt = "";
    image.src = row.preview;
    cell.append(linked(row, image));
    return cell;
  };
  const job = (row) => {
    const cell = element("td", "job");
    cell.append(linked(row, document.createTextNode(row.id)));
    if (row.error) cell.append(element("p", "error", row.error));
    return cell;
  };
  const status = (row) => {
    const cell = element("td");
    cell.append(element("span", `status ${row.status}`, WORDS[row.status]));
    return cell;
  };
  const number = (value, digits) => element("td", "right", value === null ? "" : value.toFixed(digits));
  const line = (row) => {
    const made = element("tr");
    const flips = number(row.flips, 0);
    flips.classList.toggle("alarm", row.flips > 0);
    made.append(picture(row), job(row), status(row), number(row.e_l2, 3), number(row.symmetric_dirichlet, 3), flips,
      number(row.seconds, 1));
    return made;
  };

  const grow = () => {
    body.append(...shown.slice(built, built + PAGE).map(line));
    built = Math.min(built + PAGE, shown.length);
  };
  const matches = () => {
    const text = find("search").value.trim().toLowerCase();
    const wanted = find("status").value;
    const bound = (id, none) => (find(id).value === "" ? none : Number(find(id).value));
    const [least, most] = [bound("least", -Infinity), bound("most", Infinity)];
    const isBounded = least > -Infinity || most < Infinity;
    return (row) =>
      (!text || row.id.toLowerCase().includes(text) || (row.error ?? "").toLowerCase().includes(text)) &&
      (!wanted || (wanted === "turned" ? row.flips > 0 : row.status === wanted)) &&
      (!isBounded || (row.e_l2 !== null && row.e_l2 >= least && row.e_l2 <= most));
  };
  // Rows without a value come last, whichever way the others are sorted.
  const compare = (key, up) => (a, b) => {
    const [x, y] = [a[key], b[key]];
    if (x === null || y === null) return (x === null) - (y === null);
    const sign = typeof x === "number" ? x - y : x.localeCompare(y, undefined, { numeric: true });
    return up ? sign : -sign;
  };
  const update = () => {
    shown = all.filter(matches());
    if (order.key) shown.sort(compare(order.key, order.up));
    built = 0;
    body.replaceChildren();
    grow();
    find("none").hidden = shown.length > 0;
    find("count").textContent = `${shown.length} of ${all.length}`;
  };

  for (const button of document.querySelectorAll("th button")) {
    button.addEventListener("click", () => {
      order = { key: button.dataset.key, up: order.key === button.dataset.key ? !order.up : true };
      document.querySelectorAll("th[aria-sort]").forEach((head) => head.removeAttribute("aria-sort"));
      button.closest("th").setAttribute("aria-sort", order.up ? "ascending" : "descending");
      update();
    });
  }
  for (const id of ["search", "status", "least", "most"]) find(id).addEventListener("input", update);
  const watch = new IntersectionObserver((seen) => seen.some((s) => s.isIntersecting) && built < shown.length && grow(), {
    rootMargin: "600px",
  });
  watch.observe(find("more"));
  update();
  document.documentElement.dataset.ready = "true";
})();
