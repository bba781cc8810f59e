// Rules of WCAG 2.2 A and AA and of good practice; each fault with the first elements that show it.
async (rules) => {
  const found = await axe.run(document, rules ? { runOnly: rules } : {});
  return found.violations.map((fault) => [fault.id, fault.help, fault.nodes.slice(0, 4).map((node) => `${node.html.slice(0, 160)}: ${node.failureSummary.slice(0, 300)}`)]);
}
