// Code that is wider than the page scrolls: let the keyboard reach it, also where the theme draws it anew
const reach = () => {
  for (const code of document.querySelectorAll("pre:not(.mermaid) > code:not([tabindex])")) code.tabIndex = 0;
};
new MutationObserver(reach).observe(document.body, {childList: true, subtree: true});
reach();
