// What htmx leaves to us: the slider's number, a control in use, and a program that is gone.
'use strict';

let moved = -Infinity; // ms, when a control was last moved
document.addEventListener('input', (event) => {
  moved = performance.now();
  if (event.target.id === 'n') document.getElementById('n-value').value = event.target.value;
});

// What the settings were a moment ago does not snatch the slider from the one who moves it.
document.addEventListener('htmx:oobBeforeSwap', (event) => {
  const moving = performance.now() < moved + 3000;
  if (event.detail.target.id === 'controls' && moving) event.preventDefault();
});

const lost = (is) => () => {
  document.getElementById('lost').hidden = !is;
};
for (const failure of ['htmx:sendError', 'htmx:timeout', 'htmx:responseError']) {
  document.addEventListener(failure, lost(true));
}
document.addEventListener('htmx:beforeOnLoad', (event) => {
  if (event.detail.xhr.status < 400) lost(false)();
});

// The other goals stay open when the table is replaced.
let open = false;
document.addEventListener('toggle', (event) => {
  if (event.target.isConnected) open = event.target.open;
}, true);
document.addEventListener('htmx:oobAfterSwap', () => {
  for (const details of document.querySelectorAll('details')) details.open = open;
});
