// Wide code blocks scroll; make them reachable by keyboard, even after the theme has redrawn them
const reach = () => {
  for (const code of document.querySelectorAll("pre:not(.mermaid) > code:not([tabindex])")) code.tabIndex = 0;
};
new MutationObserver(reach).observe(document.body, {childList: true, subtree: true});
reach();
