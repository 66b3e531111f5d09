/* Equations that are wider than a narrow screen are made smaller, down to what can still be read; beyond that they scroll. */
"use strict";

function fitEquations() {
  for (const box of document.querySelectorAll("div.math")) {
    const equation = box.querySelector("mjx-container");
    if (!equation) continue;
    equation.dataset.size ??= equation.style.fontSize;  // MathJax's own
    equation.style.fontSize = equation.dataset.size;
    const share = box.clientWidth / equation.scrollWidth;
    const natural = parseFloat(getComputedStyle(equation).fontSize);
    if (share < 0.995) equation.style.fontSize = `${Math.max(0.98 * share, 0.55) * natural}px`;
  }
}

window.addEventListener("load", () => {
  if (!window.MathJax || !window.MathJax.startup) return;
  window.MathJax.startup.promise.then(() => {
    fitEquations();
    window.addEventListener("resize", fitEquations);
  });
});
