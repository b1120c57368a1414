// Draws every formula of a page with the KaTeX beside it.
document.addEventListener("DOMContentLoaded", () => {
  for (const formula of document.querySelectorAll(".formula")) {
    katex.render(formula.textContent, formula, { displayMode: formula.tagName === "DIV", throwOnError: false });
  }
});
