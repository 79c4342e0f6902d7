// What htmx leaves to us: the slider's number, a control in use, what is open, a program that is gone.
'use strict';

document.documentElement.classList.add('scripts');

let moved = -Infinity; // ms, when a control was last moved
document.addEventListener('input', (event) => {
  moved = performance.now();
  const other = { 'n-slider': 'n', n: 'n-slider' }[event.target.id];
  if (other) document.getElementById(other).value = event.target.value;
});

// What the settings were a moment ago does not snatch the slider from the one who moves it.
document.addEventListener('htmx:oobBeforeSwap', (event) => {
  const moving = performance.now() < moved + 3000;
  if (event.detail.target.id === 'controls' && moving) event.preventDefault();
});

const lost = (is) => () => {
  document.getElementById('lost').hidden = !is;
  document.getElementById('status').hidden = is;
};
for (const failure of ['htmx:sendError', 'htmx:timeout', 'htmx:responseError']) {
  document.addEventListener(failure, lost(true));
}
document.addEventListener('htmx:beforeOnLoad', (event) => {
  if (event.detail.xhr.status < 400) lost(false)();
});

// What somebody has opened stays open when it is replaced.
const open = new Set();
document.addEventListener('toggle', (event) => {
  if (!event.target.isConnected) return;
  if (event.target.open) open.add(event.target.id);
  else open.delete(event.target.id);
}, true);
document.addEventListener('htmx:oobAfterSwap', (event) => {
  for (const details of event.detail.target.querySelectorAll('details')) {
    details.open = open.has(details.id);
  }
});

// A drawer is closed like one.
const drawer = document.getElementById('drawer');
document.addEventListener('keydown', (event) => {
  if (event.key === 'Escape' && drawer?.open) {
    drawer.open = false;
    drawer.querySelector('summary').focus();
  }
});
document.addEventListener('click', (event) => {
  if (drawer?.open && event.target.isConnected && !drawer.contains(event.target)) drawer.open = false;
  const copies = event.target.dataset?.copies;
  if (!copies) return;
  const text = document.getElementById(copies);
  if (navigator.clipboard) navigator.clipboard.writeText(text.textContent);
  else getSelection().selectAllChildren(text);
});
