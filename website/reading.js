// Code that is wider than the page can be scrolled: let the keyboard reach it, also after the theme has redrawn it
const reach = () => {
  for (const code of document.querySelectorAll("pre:not(.mermaid) > code:not([tabindex])")) code.tabIndex = 0;
};
new MutationObserver(reach).observe(document.body, {childList: true, subtree: true});
reach();
