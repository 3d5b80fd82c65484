; THEOREM    04a: the whole plan, first part: no contact before the command to rest takes effect.
; ASSUMED    The guard holds; until the time t <= eps the robot is no faster than w, the thing no
;            faster than V.
; CONCLUDED  The clearance is 0 at least at t.
; SOURCE     Mitsch, Ghorbal, Vogelbacher, Platzer, IJRR 36(12), 2017, Theorem 2.
; TWIN       the guard forgets that the thing moves.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const t Real)        ; time that passes
(declare-const x Real)        ; robot's own way meanwhile
; Formulas
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun time_to_rest ((w Real)) Real (+ eps (/ w b)))
(define-fun need ((w Real)) Real
  (+ (* kappa (+ s (way_to_rest w))) (* V (+ age (time_to_rest w)))))

; Assumptions
(assert (> b 0))
(assert (> eps 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= w 0))
(assert (>= t 0))
(assert (>= x 0))
(assert (<= (need w) d))
(assert (<= t eps))
(assert (<= x (* w t)))

; Conclusion, negated
(assert (not (>= (- d (* kappa (+ s x)) (* V (+ age t))) 0)))
(check-sat)
