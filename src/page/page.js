"use strict";
// What a cell counts as when its column is sorted: the number that it begins with, or its words.
function rank(cell) {
  const text = cell.textContent.trim().replace("\u2212", "-");
  const number = parseFloat(text.replace(/^[<+ ]+/, ""));
  return Number.isNaN(number) ? text : number;
}

function compare(a, b) {
  const numbers = typeof a === "number" && typeof b === "number";
  return numbers ? a - b : String(a).localeCompare(String(b));
}

function sort(heading) {
  const table = heading.closest("table");
  const body = table.tBodies[0];
  const direction = heading.ariaSort === "ascending" ? "descending" : "ascending";
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  heading.setAttribute("aria-sort", direction);
  const sign = direction === "ascending" ? 1 : -1;
  const at = heading.cellIndex;
  const rows = [...body.rows];
  rows.sort((a, b) => sign * compare(rank(a.cells[at]), rank(b.cells[at])));
  body.append(...rows);
}

for (const button of document.querySelectorAll("th button")) {
  button.addEventListener("click", () => sort(button.closest("th")));
}
