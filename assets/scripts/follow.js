// Panel's components made with React keep a copy of each value of their model, and lose track of it in two ways. They
// read it when they are drawn and listen a moment later: a change between the two is never seen. And they send back what
// they have just been told: where the page is slower than the changes, an old value lands on a newer one, so that a
// slider, its number and the run part company. Here the model alone holds the value: a component writes into it at once,
// and follows it. The code of Panel that is mended is made when its first component is, so this must come before.
(() => {
  "use strict";
  const {prototype} = Bokeh.Models.get("panel.models.esm.ReactComponent");
  const written = prototype._render_code;
  const mends = [
    ["react_proxy.on(prop, cb, true)", "$&; if (!target.model.events.includes(resolvedProp)) cb()"],
    ["targetModel.setv({ [resolvedProp]: value })", "void 0"],
    ["return [value, setValue]", `
      const write = React.useCallback((next) => {
        if (target.model.events.includes(resolvedProp)) return setValue(next)
        const now = targetModel.attributes[resolvedProp]
        targetModel.setv({[resolvedProp]: typeof next === "function" ? next(now) : next})
        setValue(targetModel.attributes[resolvedProp])
      }, [])
      return [value, write]`],
  ];
  prototype._render_code = function () {
    let code = written.call(this);
    // a release of Panel that reads otherwise stays as it is
    if (mends.every(([old]) => code.includes(old))) {
      for (const [old, mended] of mends) { code = code.replace(old, mended); }
    }
    return code;
  };
})();
