// Shows one step at a time. Without it the page shows all of them.
"use strict";
const steps = [...document.querySelectorAll("section.step")];
const bar = document.getElementById("slider");
const at = document.getElementById("at");
const all = document.getElementById("all");
const named = document.getElementById("named");

function show(number) {
  at.value = Math.min(Math.max(number, 0), steps.length - 1);
  steps.forEach((step, index) => step.classList.toggle("away", !all.checked && index !== Number(at.value)));
  named.textContent = steps[at.value].querySelector("h3").textContent;
}

function follow() {
  const number = steps.findIndex((step) => `#${step.id}` === location.hash);
  if (number >= 0) {
    show(number);
    steps[number].scrollIntoView();
  }
}

at.addEventListener("input", () => show(Number(at.value)));
document.getElementById("before").addEventListener("click", () => show(Number(at.value) - 1));
document.getElementById("after").addEventListener("click", () => show(Number(at.value) + 1));
all.addEventListener("change", () => show(Number(at.value)));
window.addEventListener("hashchange", follow);
bar.hidden = false;
show(0);
follow();
