; THEOREM    04c: the robot is at rest after time_to_rest, and has come no farther than
;            way_to_rest.
; ASSUMED    The command to rest takes effect at te <= eps; the robot brakes to rest from ve <= w
;            at b or harder.
; CONCLUDED  te + tb <= eps + w/b and xe + xb <= w eps + w^2/2b.
; SOURCE     own; spec/shield.md SH.2.
; TWIN       the command to rest takes effect later, up to twice eps.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const te Real)       ; when the command to rest takes effect
(declare-const xe Real)       ; way until then
(declare-const ve Real)       ; speed then
(declare-const tb Real)       ; time spent braking
(declare-const xb Real)       ; way while braking
; Formulas
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun time_to_rest ((w Real)) Real (+ eps (/ w b)))

; Assumptions
(assert (> b 0))
(assert (> eps 0))
(assert (>= w 0))
(assert (>= te 0))
(assert (>= xe 0))
(assert (>= ve 0))
(assert (>= tb 0))
(assert (>= xb 0))
(assert (<= te eps))
(assert (<= xe (* w te)))
(assert (<= ve w))
(assert (<= (* b tb) ve))
(assert (<= (* 2 b xb) (* ve ve)))

; Conclusion, negated
(assert (not (and (<= (+ te tb) (time_to_rest w)) (<= (+ xe xb) (way_to_rest w)))))
(check-sat)
