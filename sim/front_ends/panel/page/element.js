// Creates and updates elements, and converts values. An update does nothing if the value is the same.

export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) {
      element.addEventListener(name.slice(2), value);
    } else if (value !== null && value !== false) {
      element.setAttribute(name, value === true ? "" : value);
    }
  }
  element.append(...children);
  return element;
}

export function setText(element, text) {
  if (element.textContent !== text) {
    element.textContent = text;
  }
}

export function setAttribute(element, name, value) {
  const text = String(value);
  if (element.getAttribute(name) !== text) {
    element.setAttribute(name, text);
  }
}

/// A terminal of a module in a list of terminals.
export const terminal = (label, ...shown) => make("li", {}, make("span", {class: "screw", "aria-hidden": "true"}),
  make("span", {class: "label", "aria-hidden": "true"}, label), ...shown);

export const bit = (word, channel) => (word >> channel & 1) !== 0;
export const hexByte = (value) => value.toString(16).toUpperCase().padStart(2, "0");
