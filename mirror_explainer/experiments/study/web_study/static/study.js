// What a step does with scripts: keys 1 to 4 and S, and the time that an answer took here.
'use strict';

const form = document.getElementById('question');
let seen = performance.now(); // ms
requestAnimationFrame(() => requestAnimationFrame(() => { seen = performance.now(); }));

form.addEventListener('submit', () => {
  form.elements.in_browser.value = ((performance.now() - seen) / 1000).toFixed(3);
});

document.addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const choices = form.querySelectorAll('input[type=radio]');
  const chosen = choices[Number(event.key) - 1];
  if (chosen) {
    chosen.checked = true;
    chosen.focus();
  } else if (event.key.toLowerCase() === 's') {
    document.getElementById('same')?.click();
  } else if (event.key === 'Enter' && !event.target.closest('a, button, input, summary')) {
    form.requestSubmit();
  } else {
    return;
  }
  event.preventDefault();
});
